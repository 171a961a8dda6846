"""What the tools for assistants return: data with a schema, and a text that tells the same."""

# As in `language.base`, annotations are not postponed.
from typing import Literal

from pydantic import BaseModel, ConfigDict, PrivateAttr

Figure = int | float | str | None
"""A number; infinities are texts."""


class Result(BaseModel):
    """What a tool returns: data, and a text that tells the same."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    _picture: bytes = PrivateAttr(b"")

    @property
    def told(self) -> str:
        """The text."""
        raise NotImplementedError

    @property
    def picture(self) -> bytes:
        """A picture that belongs to it, as a PNG file; empty if there is none."""
        return self._picture


class Finding(BaseModel):
    """An error, or something that is probably not meant."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    code: str
    """The code, which `explain_rule` explains."""
    severity: Literal["error", "warning", "info"]
    line: int
    column: int
    message: str
    help: str | None
    """What to do about it."""
    excerpt: str
    """The finding with its line, and carets below what is meant."""


class Checked(Result):
    """What is found in a level."""

    is_clean: bool
    """Whether there is nothing to mend; notes alone do not count."""
    findings: list[Finding]
    left_out: int
    """How many more findings there are."""
    fixed: str | None
    """The text with the fixes that do not change the level's meaning, if that was asked for."""

    @property
    def told(self) -> str:
        """The findings and the fixed text."""
        more = [f"{self.left_out} more"] if self.left_out else []
        parts = [each.excerpt for each in self.findings] + more
        return "\n\n".join([*(parts or ["no findings"]), *filter(None, [self.fixed])])


class Page(Result):
    """A text."""

    text: str

    @property
    def told(self) -> str:
        """The text."""
        return self.text


class Drawn(Result):
    """A level as a drawing, with a picture beside it."""

    drawing: str

    @property
    def told(self) -> str:
        """The drawing."""
        return self.drawing


class Solved(Result):
    """The optimum of a level."""

    expected_return: Figure
    expected_steps: Figure
    exit_probability: Figure
    ending: str | None
    """How episodes end that do not reach an exit."""
    policy: str | None
    """The drawing with optimal actions, as episodes begin; not of large levels."""

    @property
    def told(self) -> str:
        """The figures and the drawing."""
        shown = self.model_dump(exclude={"policy"}, exclude_none=True)
        return "\n".join(
            [*(f"{name}: {value}" for name, value in shown.items()), self.policy or ""]
        )


class Measured(Result):
    """The metrics of a level, by the names that `expect` uses."""

    digest: str | None
    """What all levels share that are the same decision process."""
    metrics: dict[str, Figure | list[str]]
    reasons: dict[str, str]
    """Why metrics have no value."""

    @property
    def told(self) -> str:
        """The metrics, one on each line."""
        texts = {**self.metrics, **self.reasons}
        return "\n".join(f"{name}: {value}" for name, value in texts.items())


class Generated(Result):
    """Levels that meet the conditions."""

    levels: list[str]
    """Their texts."""

    @property
    def told(self) -> str:
        """The texts as one stream of documents."""
        return "---\n".join(self.levels)


class Answered(Result):
    """Where a play is."""

    play: str
    """The name of the play, for `play_move`."""
    text: str
    """What happened, and what is seen."""
    is_over: bool
    total: float
    """The discounted sum of the rewards so far."""
    regret: float | None
    """After the end: what the moves have lost against optimal ones."""

    @property
    def told(self) -> str:
        """What happened, and the name of the play."""
        lost = "" if self.regret is None else f"\nregret: {self.regret:g}"
        return f"play {self.play}\n{self.text}{lost}"
