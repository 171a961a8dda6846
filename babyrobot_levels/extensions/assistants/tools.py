"""The tools of the server for assistants: a level as text in, typed results out.

They read and write no files outside a folder that is named, the package's own gallery excepted.
"""

import secrets
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from babyrobot_levels.analysis.endings import ending_of
from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.analysis.pictures import to_png
from babyrobot_levels.analysis.previews import show
from babyrobot_levels.analysis.shown import actions_shown, overlay_given
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.extensions.assistants.results import (
    Answered,
    Checked,
    Drawn,
    Figure,
    Finding,
    Generated,
    Measured,
    Page,
    Solved,
)
from babyrobot_levels.extensions.assistants.skill import language_page
from babyrobot_levels.extensions.scoring.text_world import MOVES, TextWorld
from babyrobot_levels.language.documents import is_suite, theme_folders
from babyrobot_levels.language.share_code import decode, is_code
from babyrobot_levels.library.level import Level, load_document
from babyrobot_levels.library.search_path import gallery_folder
from babyrobot_levels.linter.linting import Options, outcome_of
from babyrobot_levels.linter.rules import rule
from babyrobot_levels.linter.runner import is_note
from babyrobot_levels.mdp.states import initial_configuration
from babyrobot_levels.render.text import TextPainter
from babyrobot_levels.suites.checking import formatted
from babyrobot_levels.suites.suite import load_suite
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import BabyRobotError, LevelError
from babyrobot_levels.text.files import SUFFIXES, is_within, read_source, source_of, write_text
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import MAX_BYTES, SourceFile

MAX_FINDINGS = 50
MAX_DRAWN = 4_096
"""The most cells of a level that is drawn."""
MAX_PIXELS = 800.0
"""The largest side of a picture."""
MAX_PLAYS = 16
MAX_STEPS = 1_000
MAX_GENERATED = 10

LevelText = Annotated[
    str,
    Field(
        max_length=MAX_BYTES,
        description="A level: its YAML text, the name of a level of the gallery, a share code, or, "
        "if the server has a folder, the path of a file below it.",
    ),
]
Amount = Annotated[int | str, Field(description="A number, or a range: `2..4`, `2..`, `..4`.")]


class RefusedError(BabyRobotError):
    """A call that a tool does not carry out."""


class Tools:
    """The tools; each public method is one.

    Attributes:
        folder: the folder of the files that may be read and written; None for no files.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder
        self._plays: dict[str, TextWorld] = {}

    def check(self, level: LevelText, fix: bool = False) -> Checked:
        """Check a level: errors, mistakes of play that are proved, and untrue facts in `expect`.

        Mend what is found, and check again, until `is_clean`. With `fix`, the safe fixes are
        applied to the text that is returned.
        """
        source, path = self._source(level)
        options = Options(fix=fix)
        outcome = outcome_of(options, source, options.rules, path)
        found = outcome.diagnostics
        return Checked(
            is_clean=all(map(is_note, found)),
            findings=[_finding(each) for each in found[:MAX_FINDINGS]],
            left_out=max(0, len(found) - MAX_FINDINGS),
            fixed=outcome.text,
        )

    def format(self, level: LevelText, save: str | None = None, overwrite: bool = False) -> Page:
        """Return the text of a valid level in its canonical form, with all comments.

        With `save`, it is written to that file too: a path that ends in .yaml, below the folder
        with which the server was started. A file that is there stays, unless `overwrite` is given;
        one that is no level always does.
        """
        source, path = self._source(level)
        text = formatted(source, path).text
        if save is not None:
            file = self._path(save)
            if file.exists() and not (overwrite and _is_level(file)):
                help_text = "overwrite replaces it" if _is_level(file) else "it is no level"
                raise RefusedError(f"{save} is there already: {help_text}")
            write_text(file, text)
        return Page(text=text)

    def solve(
        self,
        level: LevelText,
        discount: float | None = None,
        within: Annotated[int, Field(ge=1)] | None = None,
    ) -> Solved:
        """Compute the optimum exactly: return, steps, probability of reaching an exit, policy.

        Without `within`, a number of steps, there is no limit of steps.
        """
        world = self._level(level)
        found = solve(world, discount) if within is None else solve(world, discount, within=within)
        ending = ending_of(found)
        return Solved(
            expected_return=_figure(found.expected_return),
            expected_steps=_figure(found.expected_steps),
            exit_probability=_figure(found.exit_probability),
            ending=None if ending is None else ending.text,
            policy=_policy(world, found) if world.width * world.height <= MAX_DRAWN else None,
        )

    def preview(self, level: LevelText) -> Drawn:
        """Draw a level: as text, and as a picture."""
        world = self._level(level)
        if world.has_random_maze:
            world = world.with_maze_seed(0)
        if world.width * world.height > MAX_DRAWN:
            raise RefusedError(f"levels of up to {MAX_DRAWN:,} cells are drawn")
        drawn = Drawn(drawing=world.draw())
        drawn._picture = to_png(world, scale=min(1.0, MAX_PIXELS / (64 * max(world.size))))
        return drawn

    def generate(
        self,
        size: Annotated[str, Field(pattern=r"^\d{1,3}x\d{1,3}$")] = "8x5",
        count: Annotated[int, Field(ge=1, le=MAX_GENERATED)] = 1,
        seed: Annotated[int, Field(ge=0)] = 0,
        keys: Amount = 0,
        coins: Amount = 0,
        guards: Amount = 0,
        puddles: Amount = 0,
        wind: Amount = 0,
        path_length: Amount | None = None,
        dead_ends: Amount | None = None,
        detour: Amount | None = None,
        difficulty: Amount | None = None,
    ) -> Generated:
        """Generate mazes that meet conditions, to start from; the same seed makes the same ones.

        `detour` is how many steps keys, guards and wind add to the shortest path.
        """
        given = {name: value for name, value in locals().items() if value not in (self, None)}
        given["size"] = [int(side) for side in size.split("x")]
        suite = load_suite({"version": 1, "kind": "suite", **given})
        return Generated(levels=[suite[number].to_yaml() for number in range(count)])

    def metrics(self, level: LevelText) -> Measured:
        """Measure a level: the exact values of what `expect` can state.

        Above 5,000 states, those for which the level would have to be solved are left out.
        """
        world = self._level(level)
        facts = show(world)
        numbers = facts["metrics"] or {}
        missing = [name for name, value in numbers.items() if value is None]
        reasons = {name: Metrics(world).why_none(name) for name in missing}
        if not numbers:
            reasons = {"metrics": facts.left_out or "a random maze has none before it is drawn"}
        return Measured(digest=facts["digest"], metrics=numbers, reasons=reasons)

    def explain_rule(self, code: str) -> Page:
        """Explain the code of a finding, such as BR503: what it means, why, and an example."""
        return Page(text=rule(code[:100]).page)

    def language_reference(self) -> Page:
        """Return the language of levels on one page: drawings, fields, facts, traps."""
        return Page(text=language_page())

    def play_start(
        self,
        level: LevelText,
        seed: Annotated[int, Field(ge=0, lt=2**31)] | None = None,
        sight: Literal["map", "view", "words", "picture"] = "map",
        within: Annotated[int, Field(ge=1, le=MAX_STEPS)] | None = None,
    ) -> Answered:
        """Begin an episode that is played by `play_move`, and return its rules and what is seen.

        With the sight `picture`, what is seen is a picture beside the text.
        """
        world = self._level(level)
        limit = within or min(world.max_steps or MAX_STEPS, MAX_STEPS)
        play = TextWorld(world, sight=sight, within=limit)
        text = play.reset(seed=seed)
        name = secrets.token_hex(8)
        self._plays[name] = play
        if len(self._plays) > MAX_PLAYS:
            del self._plays[next(iter(self._plays))]
        return _answered(name, play, text)

    def play_move(
        self,
        play: str,
        move: Literal[
            "north",
            "east",
            "south",
            "west",
            "north-east",
            "south-east",
            "south-west",
            "north-west",
            "wait",
            "look",
        ],
    ) -> Answered:
        """Make a move in a play, or look around, which takes no step."""
        world = self._plays.get(play)
        if world is None:
            raise RefusedError(
                f"there is no such play; the last {MAX_PLAYS} are kept: begin one by play_start"
            )
        if move in MOVES:
            return _answered(play, world, world.move(move))
        return _answered(play, world, world.wait() if move == "wait" else world.look())

    # -- levels and files ------------------------------------------------------------------

    def _level(self, given: str) -> Level:
        """Return a level; see `_source` for errors."""
        source, path = self._found(given)
        document = read(source)
        _refuse_suite(document)
        return load_document(document, path)

    def _source(self, given: str) -> tuple[SourceFile, Path | None]:
        """Return the text of a level, and the file that it is from, if it is from one.

        Raises:
            RefusedError: it is a suite, which can name other files, or it may not be read.
            LevelError: the text cannot be read.
        """
        source, path = self._found(given)
        with suppress(LevelError):
            _refuse_suite(read(source))
        return source, path

    def _found(self, given: str) -> tuple[SourceFile, Path | None]:
        path = None
        if is_code(given):
            source = decode(given)
        elif "\n" in given or ": " in given:
            source = source_of(given.encode("utf-8", "surrogatepass"), "level.yaml")
        else:
            path = _in_gallery(given) or self._path(given)
            source = read_source(path, given)
        return source, path if path is not None and self._has_its_themes(path) else None

    def _has_its_themes(self, path: Path) -> bool:
        """Whether only the folder is searched for themes: packs are, up to their first folder."""
        around = gallery_folder() if self.folder is None else self.folder
        return all(is_within(each, around) for each in theme_folders(path.parent))

    def _path(self, given: str) -> Path:
        """Return the path of a file of the folder.

        Raises:
            RefusedError: there is no folder, or the file is not in it.
        """
        if self.folder is None:
            raise RefusedError(
                "this is no level of the gallery, and the server was started without --folder: "
                "give the text of the level"
            )
        path = self.folder / given
        if path.suffix not in SUFFIXES or not is_within(path, self.folder):
            raise RefusedError("a file must lie below the folder of the server, and end in .yaml")
        return path


def _refuse_suite(document: Document) -> None:
    """Refuse a suite, which can name other files."""
    if is_suite(document):
        raise RefusedError("this is a suite; the tools take one level")


def _is_level(path: Path) -> bool:
    """Tell whether a file says that it is a level, perhaps with errors."""
    with suppress(LevelError):
        data = read(read_source(path)).data
        return isinstance(data, dict) and data.get("version") == 1 and "kind" not in data
    return False


def _in_gallery(name: str) -> Path | None:
    paths = gallery_folder().glob("**/*.yaml")
    return next((path for path in paths if path.stem == name), None)


def _policy(level: Level, found: Solution) -> str:
    """Return the drawing with an optimal action in each cell, as episodes begin."""
    number = initial_configuration(level) if level.has_things else None
    overlay = overlay_given(level, {"policy": found}).at(number)
    shown = actions_shown(found, number)
    painter = TextPainter(level, plain=True, overlay=replace(overlay, actions=shown, caption=""))
    legend = painter.explained(caption=overlay.caption, configuration=number)
    return "\n".join([*painter.lines(None, configuration=number, held=False), *legend])


def _finding(found: Diagnostic) -> Finding:
    given: dict[str, Any] = found.to_dict()
    return Finding(**{name: given[name] for name in Finding.model_fields if name in given},
                   excerpt=found.shown(100))  # fmt: skip


def _answered(name: str, play: TextWorld, text: str) -> Answered:
    regret = play.regret if play.done else None
    told = Answered(play=name, text=text, is_over=play.done, total=play.return_, regret=regret)
    told._picture = play.picture or b""
    return told


def _figure(value: float) -> Figure:
    return value if abs(value) < float("inf") else str(value)
