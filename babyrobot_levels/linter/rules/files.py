"""Rules about level files: their names, their descriptions, and copies of the same MDP."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.documents import slug
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Severity

EQUIVALENT_MDP = "BR515"
"""The code of `equivalent_mdp`, which the runner calls for files with equal digests."""


@rule(EQUIVALENT_MDP, compares_files=True)
def equivalent_mdp(other: str) -> Iterator[Finding]:
    """Level with the same MDP as another level of its folder.

    ## What it does

    Checks for level files of one folder whose digests are equal: grid, starts, exits, and every
    transition probability and reward. Names, colours and the notation may differ.

    ## Why is this bad?

    A duplicate counts twice in a course, a benchmark or a training set. If one copy is used for
    training and the other for testing, the result does not measure generalisation. Often one of the
    two was meant to be different.

    ## How to fix it

    Remove one of the files, or make it the level that it was meant to be. If both are intended,
    suppress the finding at the top of the second file: `# babyrobot: ignore[BR515] reason`.
    """
    yield Finding(
        (),
        f"this level has the same MDP as {other}",
        "remove one of the two, or make it the level that it was meant to be",
    )


@rule("BR601", Severity.INFO, needs=Needs.LEVEL)
def file_name_mismatch(context: LintContext) -> Iterator[Finding]:
    """`name` that differs from the file's name.

    ## What it does

    Checks for levels whose `name` is not the stem of their file. A level is found by its `name`,
    and by the stem of its file if it has none.

    ## Why is this bad?

    A reader of `brl.load("red-maze")` looks for a file `red-maze.yaml`, and a reader of the file
    types its name.

    ## How to fix it

    Rename the file, or remove the field `name`.
    """
    given = context.data.get("name")
    if context.path is None or given is None:
        return
    stem = slug(context.path.stem)
    if stem is not None and given != stem:
        yield Finding(
            ("name",),
            f"the level is named `{given}`, but its file is {context.path.name}",
            f"rename the file to {given}{context.path.suffix}, or remove `name`",
        )


@rule("BR602", Severity.INFO, needs=Needs.LEVEL, default=False)
def no_description(context: LintContext) -> Iterator[Finding]:
    """Level without a description.

    ## What it does

    Checks for levels whose `description` is missing or empty. The rule is off by default; select it
    for levels that others will use.

    ## Why is this bad?

    Galleries, packs and `babyrobot show` print the description. Without it, users have to play the
    level to learn its purpose.

    ## Example

    ```yaml
    version: 1
    size: [4, 1]
    ```

    Use instead:

    ```yaml
    version: 1
    description: A corridor of four cells to test that learning works at all.
    size: [4, 1]
    ```
    """
    if not (context.level.description or "").strip():
        yield Finding((), "the level has no description", "state its purpose in `description`")


@rule("BR611", Severity.INFO, needs=Needs.LEVEL)
def yml_suffix(context: LintContext) -> Iterator[Finding]:
    """Level file with the suffix `.yml`.

    ## What it does

    Checks for level files whose name does not end in `.yaml`.

    ## Why is this bad?

    Some tools and editors only recognise `.yaml` files as levels. With two suffixes there can be
    two files, `maze.yaml` and `maze.yml`, one of which is not found.

    ## How to fix it

    Rename the file.
    """
    if context.path is not None and context.path.suffix == ".yml":
        name = f"{context.path.stem}.yaml"
        yield Finding(
            (),
            f"the suffix of {context.path.name} is `.yml` instead of `.yaml`",
            f"rename the file to {name}",
        )


@rule("BR612", Severity.INFO, needs=Needs.LEVEL, default=False)
def no_schema_line(context: LintContext) -> Iterator[Finding]:
    """Level file without a schema line.

    ## What it does

    Checks for level files that do not begin with a comment that names a schema for editors. The
    rule is off by default; select it for files that are written by hand.

    ## Why is this bad?

    With `# yaml-language-server: $schema=...` as the first line, editors complete field names, show
    their documentation, and underline mistakes while you type. `babyrobot new-level` writes it.

    ## Example

    ```yaml
    version: 1
    ```

    Use instead:

    ```yaml
    # yaml-language-server: $schema=../schemas/level.schema.json
    version: 1
    ```
    """
    first = context.document.root.span.start.line
    above = (comment for comment in context.comments if comment.span.start.line < first)
    if not any("yaml-language-server:" in comment.text for comment in above):
        yield Finding(
            (),
            "the file does not begin with a schema line",
            "begin with `# yaml-language-server: $schema=...`, as `babyrobot new-level` does",
        )
