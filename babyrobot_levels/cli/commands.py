"""The commands by what they are for. A command's module is imported when the command is run."""

import inspect
import re
from ast import literal_eval
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial, wraps
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from babyrobot_levels import __version__
from babyrobot_levels.cli import meant
from babyrobot_levels.registry.entries import Entries, built_in, resolve
from babyrobot_levels.registry.manifest import Command
from babyrobot_levels.text.budget import COMMAND, UNLIMITED, within
from babyrobot_levels.text.words import words_beside

_SUPPORT = "Editors and assistants"


def _core(group: str, place: str, summary: str, *, limited: bool = False) -> Command:
    """Return a command of this room, by its module and function."""
    return Command(group, f"babyrobot_levels.cli.{place}", summary, limited)


_OWN: Mapping[str, Command | str] = {
    "new-level": _core("Create", "create:new_level", "Write a new level file."),
    "generate": "generate",
    "edit": "editor",
    "import": "formats",
    "validate": _core("Check", "check:validate", "Check level files for errors."),
    "lint": _core("Check", "lint:lint", "Check level files for errors and likely mistakes."),
    "format": _core("Check", "check:format_levels", "Format level files."),
    "expect": "expect",
    "rule": _core("Check", "lint:rule", "Explain an error code or a lint rule."),
    "preview": _core(
        "Look and play", "preview:preview", "Draw a level, or save a picture or page.", limited=True
    ),
    "play": "play",
    "replay": "scoring",
    "show": _core("Look and play", "show:show", "Show the facts about a level.", limited=True),
    "list": _core("Look and play", "show:list_levels", "List levels, suites or packs."),
    "solve": _core(
        "Analyse", "solve:solve", "Compute an optimal policy and its values.", limited=True
    ),
    "score": "scoring",
    "grade": "scoring",
    "compare": "compare",
    "diff": "compare",
    "check-plan": "robots",
    "share": _core(
        "Share", "share:share", "Print a level as a share code or a link.", limited=True
    ),
    "sheet": "publish",
    "export": "formats",
    "gallery": "publish",
    "dataset": "publish",
    "course": "publish",
    "resolve": _core("Share", "share:resolve", "Write out a level's maze as walls."),
    "pack": "packs",
    "install": "packs",
    "uninstall": "packs",
    "schema": _core(_SUPPORT, "create:print_schema", "Print a JSON schema."),
    "mcp": "assistants",
    "skill": "assistants",
}
"""The commands of the package in their order: those of this room, and whose manifest has others."""


class _Own(Mapping[str, Command]):
    """The commands of the package; a manifest is read when somebody asks for what it has."""

    def __getitem__(self, name: str) -> Command:
        found = _OWN[name]
        return found if isinstance(found, Command) else built_in(found).commands[name]

    def __iter__(self) -> Iterator[str]:
        return iter(_OWN)

    def __len__(self) -> int:
        return len(_OWN)


COMMANDS: Mapping[str, Command] = _Own()
"""The commands of the package. Those of extensions are asked for where another one is meant."""

_ALL = Entries("commands", COMMANDS, lambda each: isinstance(each, Command))


def function_of(name: str) -> Callable[..., Any]:
    """Import the function of a command."""
    command = _ALL[name]
    function = (resolve if name in COMMANDS else partial(_ALL.imported, name))(command.place)
    return _limited(function) if command.limited else function


@cache
def _command(name: str) -> Any:
    function = function_of(name)
    alone = typer.Typer(add_completion=False, **_PLAIN)
    cls = getattr(function, "command_class", None)
    alone.command(name, short_help=_ALL[name].summary, cls=cls)(function)
    return typer.main.get_command(alone)


_LIMITS = replace(COMMAND, help="use a smaller level, or go on all the same with --no-limit")
_NO_LIMIT = Annotated[
    bool,
    typer.Option(
        "--no-limit",
        help="Take as much time and memory as it needs.  "
        f"[default: at most about {COMMAND.seconds} s and {COMMAND.megabytes / 1000} GB]",
    ),
]


def _limited(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a command with one more option, `--no-limit`."""

    @wraps(function)
    def run(no_limit: bool = False, **options: Any) -> Any:
        with within(UNLIMITED if no_limit else _LIMITS):
            return function(**options)

    own = inspect.signature(function, eval_str=True).parameters.values()
    last = inspect.Parameter("no_limit", inspect.Parameter.KEYWORD_ONLY, default=False)
    parameters = [*own, last.replace(annotation=_NO_LIMIT)]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {each.name: each.annotation for each in parameters}
    return run


class _Registry(Mapping[str, Any]):
    """The commands by name, each of which is imported when it is asked for."""

    def __getitem__(self, name: str) -> Any:
        return _command(name)

    def __iter__(self) -> Iterator[str]:
        return iter(_ALL)

    def __len__(self) -> int:
        return len(_ALL)


_UsageError: Any = typer.BadParameter.__mro__[1]
_EXTRA = re.compile(r"unexpected extra argument\S* \(([^ )]+)")
_CHOICE = re.compile(r"('.*') is not one of (.*)\.")


def _plain(cause: Any) -> str | None:
    """Return in our words what pydantic says of a number; None for all else."""
    first: dict[str, Any] = cause.errors()[0] if hasattr(cause, "errors") else {}
    told: str | None = words_beside(meant.__file__)["numbers"].get(first.get("type", ""))
    return told and told.format(input=first["input"], **first.get("ctx", {}))


class _Commands(TyperGroup):
    """The group of all commands."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands: Any = _Registry()

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands."""
        return list(_ALL)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that is meant, or suggest similar ones."""
        name = args[0]
        if name not in _ALL and not name.startswith("-") and not ctx.resilient_parsing:
            known = {each: command.summary for each, command in _ALL.items()}
            ctx.fail(f"No such command {name!r}.{meant.commands(name, known, *args[1:2])}")
        return super().resolve_command(ctx, args)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Find the options of the program itself, and tell where those of commands stand."""
        command = next((each for each in args if each in _ALL), None)
        try:
            return super().parse_args(ctx, [*args])
        except _UsageError as error:
            if command and hasattr(error, "option_name"):
                error.message += f". Options stand behind the command: `babyrobot {command} …`"
            raise

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, group by group, without importing them."""
        width = max(map(len, _ALL))
        for group in dict.fromkeys(command.group for command in _ALL.values()):
            rows = [
                (name.ljust(width), command.summary)
                for name, command in _ALL.items()
                if command.group == group
            ]
            with formatter.section(group):
                formatter.write_dl(rows)

    def invoke(self, ctx: Any) -> Any:
        """Run the command, or report what is wrong with the call."""
        words = [*ctx._protected_args, *ctx.args]
        try:
            return super().invoke(ctx)
        except typer.BadParameter as error:
            # What a user typed was a word, not a value that raised an error.
            error.message = _plain(error.__cause__) or error.message.removeprefix("Value error, ")
            if found := _CHOICE.fullmatch(error.message):
                error.message += meant.choice(*map(literal_eval, found.groups()))
            raise
        except _UsageError as error:
            command: Any = error.ctx.command if error.ctx else self
            known = {name: each for each in command.params for name in each.opts}
            if (name := getattr(error, "option_name", None)) and "No such" in error.message:
                if told := meant.option(name, known, words):
                    error.possibilities = None
                    error.message += told
            elif found := _EXTRA.search(error.message):
                error.message += meant.extra(found[1], known, words)
            raise


_PLAIN: dict[str, Any] = {"rich_markup_mode": None, "pretty_exceptions_enable": False}

app = typer.Typer(
    name="babyrobot",
    cls=_Commands,
    help="Create, check, play, solve and share grid worlds that are stored as YAML files.",
    epilog="A LEVEL is a name (see `babyrobot list`), PACK/NAME, the path of a file, a share "
    "code, or `-` for standard input.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    **_PLAIN,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"babyrobot-levels {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", "-V", callback=_print_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None:
    """Create, check, play, solve and share grid worlds that are stored as YAML files."""
