"""Rules about level files: names, descriptions, copies, and comments that suppress nothing."""

from collections.abc import Iterator

from babyrobot_levels.language.names import slug
from babyrobot_levels.linter.context import LintContext, Suppression
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.rule import is_known, rule
from babyrobot_levels.text.diagnostics import Edit, Fix, Severity
from babyrobot_levels.text.source import Position, Span

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


# It runs last, because its code is the highest.
@rule("BR699", Severity.INFO, needs=Needs.LEVEL)
def unused_ignore(context: LintContext) -> Iterator[Finding]:
    """Comment that suppresses a rule without findings.

    ## What it does

    Checks for comments such as `# babyrobot: ignore[BR503] reason` that suppress nothing: because
    the rule finds nothing there, the comment is on the wrong line, or the rule does not exist.
    Rules that are not selected do not run, and comments for them are not reported.

    ## Why is this bad?

    An unused suppression hides the next problem on that line.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]  # babyrobot: ignore[BR503] the pit is intended
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    ```

    ## Fix safety

    The fix removes the rule from the comment, and the comment with its last rule. It is safe: the
    level stays the same.
    """
    for suppression in context.suppressions:
        if not suppression.words:
            yield Finding(
                suppression.comment.span,
                "unused suppression: the comment names no rule",
                "name the rules: `# babyrobot: ignore[BR503] reason`",
            )
            continue
        unknown = [word for word in suppression.words if not is_known(word)]
        idle = [
            word
            for word in suppression.words
            if word not in suppression.used and word.lower() in context.active - {"br699"}
        ]
        if useless := [word for word in suppression.words if word in {*unknown, *idle}]:
            words = ", ".join(f"`{word}`" for word in useless)
            what = f"{words} finds nothing here" if idle else f"unknown rule {words}"
            yield Finding(
                suppression.comment.span,
                f"unused suppression: {what}",
                f"remove {words} from the comment",
                fix=Fix(f"remove {words}", (_without(suppression, useless, context),)),
            )


def _without(suppression: Suppression, useless: list[str], context: LintContext) -> Edit:
    comment = suppression.comment
    if kept := [word for word in suppression.words if word not in useless]:
        before, _, rest = comment.text.partition("[")
        return Edit(comment.span, f"{before}[{', '.join(kept)}]{rest.partition(']')[2]}")
    line = comment.span.start.line
    if comment.is_alone:
        return Edit(Span(Position(line, 1), Position(line + 1, 1)), "")
    before = context.source.line(line)[: comment.span.start.column - 1].rstrip()
    return Edit(Span(Position(line, len(before) + 1), comment.span.end), "")
