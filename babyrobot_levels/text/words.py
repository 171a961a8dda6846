"""Words for messages: what the YAML parser means, the nearest known name, shortened values."""

import difflib
import inspect
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dis import opname
from enum import EnumType
from functools import cache, wraps
from itertools import chain
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from types import FunctionType, ModuleType, NoneType, UnionType
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

SHORT = 40
"""How many characters of a text from a file a message repeats."""


LINES_BACK = 100
"""So many lines above an error are searched for its cause."""


class Words(NamedTuple):
    """What a syntax error means.

    Attributes:
        message: what is wrong.
        help: what to do about it.
        at_beginning: whether it is shown where the part begins. The parser notices some errors
            only at the end of the text; what is not closed is better shown where it opens.
        place: line and column (from 1) of the cause, if it is somewhere else.
    """

    message: str
    help: str | None = None
    at_beginning: bool = False
    place: tuple[int, int] | None = None


_NO_SPACE = r"\s*[a-z_]+:(?=[^\s:/])"
_DRAWING = r"[+|]"
_BLOCK_MAP = r"\s*map:\s*\|[-+]?\s*(#.*)?"
_COMMENT_COLOR = r"[:,\[{]\s+(#[0-9a-fA-F]{3,8})(?=\s*(?:[,\]}]|$))"


def plain_words(problem: str, context: str, lines: Sequence[str], line: int, column: int) -> Words:
    """Return what a syntax error means.

    Args:
        problem: what the parser says is wrong.
        context: what it was doing.
        lines: the lines of the text.
        line: the line on which it noticed, from 1.
        column: the place in the line, from 1.
    """
    text = lines[line - 1] if line <= len(lines) else ""
    here, before = text[column - 1 : column], text[: column - 1].strip()
    if here == "\t" or ("\t" in text[: column - 1] and not before):
        return Words("tabs cannot be used for indentation", "indent with spaces")
    return (
        _unindented_drawing(lines, line)
        or _comment_for_color(f"{problem} {context}", lines, line)
        or _slashes(f"{problem} {context}", lines)
        or _missing_space(problem, lines, line)
        or _by_problem(problem, context, text, column)
    )


def _unindented_drawing(lines: Sequence[str], line: int) -> Words | None:
    """Recognise a drawing that is not indented below its `map: |`."""
    for number in range(min(line, len(lines)), 1, -1):
        if not re.match(_DRAWING, lines[number - 1]):
            continue
        if re.fullmatch(_BLOCK_MAP, lines[number - 2]):
            help_text = "indent the drawing below `map: |`, for example by two spaces"
            return Words("the drawing is not indented", help_text, place=(number, 1))
    return None


def _comment_for_color(complaint: str, lines: Sequence[str], line: int) -> Words | None:
    """Recognise a colour without quotes in flow style, which YAML takes for a comment."""
    if "flow" not in complaint:
        return None
    for number in range(min(line, len(lines)), max(line - LINES_BACK, 0), -1):
        text = lines[number - 1]
        found = re.search(_COMMENT_COLOR, text)
        before = text[: found.start() + 1] if found is not None else ""
        is_open = sum(map(before.count, "[{")) > sum(map(before.count, "]}"))
        if found is not None and is_open:
            help_text = f'put quotes around the colour: `"{found[1]}"`'
            return Words("`#` begins a comment here", help_text, place=(number, found.start(1) + 1))
    return None


def _slashes(complaint: str, lines: Sequence[str]) -> Words | None:
    """Recognise a comment of JavaScript, of which the parser complains where a part begins."""
    if "flow" not in complaint:
        return None
    for number, text in enumerate(lines[:LINES_BACK], 1):
        if text.lstrip().startswith("//"):
            return Words("`//` begins no comment", "begin comments with `#`", place=(number, 1))
    return None


def _missing_space(problem: str, lines: Sequence[str], line: int) -> Words | None:
    """Recognise `field:value`, of which the parser complains on a line below."""
    if "mapping values are not allowed" not in problem and "expected ':'" not in problem:
        return None
    for number in (line, line - 1):
        text = lines[number - 1] if 0 < number <= len(lines) else ""
        found = re.match(_NO_SPACE, text)
        if found is not None:
            message = "missing space after `:`"
            return Words(message, "add a space after `:`", place=(number, found.end()))
        if found := re.match(r" *([a-z_]+) ?= ?(\S.{0,60})", text):
            told = f"write `{found[1]}: {found[2].strip()}`"
            return Words("`=` stands where `:` belongs", told, place=(number, found.end(1) + 1))
    return None


def _by_problem(problem: str, context: str, line: str, column: int) -> Words:
    here, before = line[column - 1 : column], line[: column - 1].strip()
    for fragment, pattern, *told, at_beginning in words_beside(__file__)["problems"]:
        if fragment in problem and re.search(pattern, f"{context}\n{line}"):
            given = {"here": here, "next": line[column : column + 1]}
            message, help_text = (each.format(**given) for each in told)
            return Words(message, help_text or None, at_beginning)
    if "expected key" in problem or "'-' indicator" in problem:
        if before and before != "-":
            if here in ",;":
                return Words(
                    f"unexpected `{here}` after the value", "remove it: each field has a line"
                )
            if line[column - 1 :].startswith("//"):
                return Words("`//` begins no comment", "begin comments with `#`")
            if here == "[":
                return Words("unexpected `[` after the list", "a cell is one list: `[x, y]`")
            return Words("unexpected text after the value", "put quotes around the whole text")
        return Words(
            "the indentation does not match the lines above",
            "start the fields of a mapping, and the entries of a list, in the same column",
        )
    return Words(f"invalid YAML: {problem}" + (f" {context}" if context else ""))


def shortened(value: Any) -> str:
    """Return a text or a number as a message repeats it: on one line, and not too long."""
    text = str(value).replace("\n", " ")
    return text if len(text) <= SHORT else text[: SHORT - 3] + "…"


MAX_LENGTH = 64
"""Longer texts are not compared, which would take long."""


FEW = 24
"""So many names are listed where none of them is like the one that was given."""


def nearest(name: str, known: Iterable[str], count: int = 3, likeness: float = 0.6) -> list[str]:
    """Return up to `count` of the known names that look like `name`, the likeliest first."""
    if len(name) > MAX_LENGTH:
        return []
    by_folded = {candidate.casefold(): candidate for candidate in known}
    folded = name.casefold()
    matches = difflib.get_close_matches(folded, list(by_folded), n=count, cutoff=likeness)
    if not matches and len(folded) > 2:
        # Abbreviations are unlike the whole word.
        matches = [candidate for candidate in by_folded if candidate.startswith(folded)][:count]
    return [by_folded[match] for match in matches]


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return names as a list in words: `a, b and c`."""
    return f" {last} ".join([", ".join(names[:-1]), *names[-1:]] if len(names) > 1 else names)


@cache
def words_beside(module: str) -> dict[str, Any]:
    """Return the tables of words in the TOML file beside a module, read when they are needed.

    Args:
        module: the module's `__file__`.
    """
    import tomllib

    return tomllib.loads(Path(module).with_suffix(".toml").read_text("utf-8"))


def meant(name: str, known: Collection[str], *kinds: str) -> str:
    """Return `; did you mean …?` with the known name, or what else others call by this name.

    Args:
        name: the name.
        known: the names that there are.
        kinds: what it may be, of `attributes` and `keywords`.
    """
    folded = name.casefold()
    others = dict(chain.from_iterable(words_beside(__file__)[kind].items() for kind in kinds))
    for ours, words in others.items():
        own, _, written = ours.partition(" -> ")
        if own in known and folded in words.casefold().split():
            return f"; did you mean `{written.format(name) or own}`?"
    if found := nearest(name, known, 1, 0.62):
        return f"; did you mean `{found[0]}`?"
    theirs = [
        word
        for ours in others
        if ours.partition(" -> ")[0] in known
        for word in others[ours].split()
    ]
    if alike := [each for each in nearest(name, theirs, 1, 0.8) if each.casefold() != folded]:
        return meant(alike[0], known, *kinds)
    return f"; there are {', '.join(known)}" if 0 < len(known) <= FEW else ""


def no_attribute(owner: Any, name: str) -> AttributeError:
    """Return the error that an object, a class or a module has no attribute of a name."""
    kind = "module" if isinstance(owner, ModuleType) else "type object"
    is_named = isinstance(owner, ModuleType | type)
    what = f"{kind} {owner.__name__!r}" if is_named else f"{type(owner).__name__!r} object"
    guess = ""
    # Libraries ask for names with underscores only to see whether they are there.
    if not name.startswith("_"):
        members = getattr(owner, "__members__", None) or dir(owner)
        known = [each for each in members if not each.startswith("_")]
        guess = meant(name, known, "attributes", "keywords")
        if isinstance(owner, ModuleType) and name in dir(owner.Level):
            guess = f"; did you mean `level.{name}`, of `level = brl.load(…)`?"
    # With a name, Python would add a guess of its own.
    return AttributeError(f"{what} has no attribute {name!r}{guess}", name="", obj=None)


class Public:
    """A class that, where it says `public`, is known by its name in the package.

    Its methods tell what is wrong with a call, but for those that are called for each step.
    """

    __slots__ = ()

    def __init_subclass__(cls, *, public: bool = False) -> None:
        super().__init_subclass__()
        if public:
            cls.__module__ = __name__.partition(".")[0]
        for name, each in [*vars(cls).items()]:
            is_public = (not name.startswith("_") and name != "step") or name == "__init__"
            if isinstance(each, FunctionType) and is_public and not hasattr(each, "__wrapped__"):
                setattr(cls, name, telling(each))
            elif isinstance(each, classmethod) and is_public:
                setattr(cls, name, classmethod(telling(each.__func__)))


class Telling(Public):
    """Tells which attribute is meant by the name of one that there is not."""

    __slots__ = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            inherited = getattr(super(), "__getattr__", None)
            if name.startswith("_") and inherited is not None:
                return inherited(name)
            if inspect.getattr_static(type(self), name, None) is not None:
                # A property raised the error: let it do so again.
                return object.__getattribute__(self, name)
            added = self._added(name)
            if added is None:
                raise no_attribute(self, name)
            return added

        def _added(self, name: str) -> Any:
            """Return an attribute that somebody else adds, None if nobody does."""
            return None


def no_item(owner: Any, name: Any) -> NoReturn:
    """Raise the error that an object is asked for an entry and has attributes, with the one meant.

    Raises:
        TypeError: always.
    """
    told = ""
    if isinstance(name, str):
        names = [each for each in dir(owner) if not each.startswith("_")]
        told = f"; did you mean `.{name}`?" if name in names else meant(name, names, "attributes")
    raise TypeError(f"{type(owner).__name__!r} object is not subscriptable{told}")


class TellingEnum(EnumType):
    """The class of enumerations that tell which member is meant, and whose members are words."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            raise no_attribute(cls, name)

        def __getitem__(cls, name: str) -> Any:
            if name not in cls._member_map_:
                raise KeyError(str(no_attribute(cls, name)))
            return cls._member_map_[name]


def unexpected(function: str, name: str, known: Collection[str]) -> str:
    """Return the message that a function has no such keyword, with the one that is meant."""
    guess = meant(name, [each for each in known if each != "self"], "keywords")
    return f"{function}() got an unexpected keyword argument {name!r}{guess}"


def check_places(function: Callable[..., Any], args: Any, known: inspect.Signature) -> None:
    """Raise a TypeError, with the names to give, if a call has more arguments without one."""
    each = known.parameters.values()
    placed = [one.name for one in each if one.kind is one.POSITIONAL_OR_KEYWORD]
    if len(args) <= len(placed) or any(one.kind is one.VAR_POSITIONAL for one in each):
        return
    named = [one for one in each if one.kind is one.KEYWORD_ONLY]
    # Of a method, nobody gives the object.
    is_method = hasattr(type(args[0]), called(function))
    first = listed([f"`{name}`" for name in placed[is_method:] if name != "self"])
    told = f"takes {first} without a name, all else by name: " if first else "takes all by name: "
    told += ", ".join(f"{one.name}=…" for one in named[:10]) or "name=…"
    if isinstance(args[-1], dict):
        told += f"; of a mapping, {called(function)}(**mapping)"
    is_closed = not (named or any(one.kind is one.VAR_KEYWORD for one in each))
    only = f"takes {f'only {first}' if first else 'no arguments'}"
    raise TypeError(f"{called(function)}() {only if is_closed else told}")


def called(function: Callable[..., Any]) -> str:
    """Return the name by which a function is called: of a constructor, that of its class."""
    return function.__qualname__.removesuffix(".__init__").rpartition(".")[2]


def telling(function: Callable[P, T], known: inspect.Signature | None = None) -> Callable[P, T]:
    """Let a function tell what is wrong with a call, where Python would tell it in its own words.

    Args:
        function: the function.
        known: its signature, where that is not its own.
    """
    code = function.__code__
    if known is None and hasattr(function, "__wrapped__"):
        known = inspect.signature(function)
    most, names = code.co_argcount, code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    by_name = frozenset(known.parameters if known else names)

    @wraps(function)
    def checked(*args: P.args, **given: P.kwargs) -> T:
        if len(args) > most or not by_name.issuperset(given):
            check_call(function, args, given, known or inspect.signature(function))
        try:
            return function(*args, **given)
        except (*_OF_CALLS, FileNotFoundError) as error:
            told = explained(error, function, args, given, known or inspect.signature(function))
            if told is None:
                raise
            raise told from None

    return checked


def check_call(
    function: Callable[..., Any], args: Any, given: Collection[str], known: inspect.Signature
) -> None:
    """Raise a TypeError if a call has arguments by names that nobody knows, or too many others."""
    names = known.parameters
    takes_more = any(each.kind is each.VAR_KEYWORD for each in names.values())
    for name in (each for each in given if each not in names):
        keywords = words_beside(__file__)["keywords"].items()
        textbooks = " ".join(words for ours, words in keywords if ours in names).split()
        if not takes_more or name in textbooks or nearest(name, names, 1, 0.85):
            raise TypeError(unexpected(called(function), name, names))
    check_places(function, args, known)


def no_file(path: str, near: Sequence[str] = ()) -> str:
    """Return `; …` with what is meant by a path at which nothing is, or an empty text."""
    if re.match("https?:/", path):
        return "; this is an address of the web: download what is there, and give its file"
    if "," in path:
        return "; give each of several by itself"
    return f"; did you mean {listed(near, 'or')}?" if near else ""


_OF_CALLS = (TypeError, AttributeError, LookupError, ValueError, AssertionError)
"""What Python raises where values of wrong types are worked on."""


class MissingFileError(FileNotFoundError):
    """There is no file or folder at a path."""

    def __str__(self) -> str:
        path, near = Path(self.filename), list[str]()
        with suppress(OSError):
            near = nearest(str(path), map(str, path.parent.iterdir()))
        return f"there is no file or folder {path}{no_file(str(path), near)}"


def explained(
    error: Exception, function: Callable[..., Any], args: Any, given: Any, known: inspect.Signature
) -> Exception | None:
    """Return an error that says what is wrong with a call that raised another one, if it does."""
    if type(error) is FileNotFoundError and error.filename:
        return MissingFileError(error.errno, error.strerror, error.filename)
    name = called(function)
    level, other, *_ = *(each for each in known.parameters if each != "self"), "", ""
    first, second = [*args["self" in known.parameters :], None, None][:2]
    if _looks_like_agent(first) and not _looks_like_agent(second) and other in ("agent", "policy"):
        return TypeError(f"the level comes first: `brl.{name}({level}, {other})`")
    public = sys.modules[__name__.partition(".")[0]]
    if isinstance(first, list | tuple) and f"{name}_many" in public.__all__:
        return TypeError(f"{name}() takes one level; `brl.{name}_many(levels)` takes several")
    if isinstance(first, list | tuple) and {"level", "levels"} <= known.parameters.keys():
        return TypeError(f"{name}() takes one level, or several as `levels=…`")
    if _is_told(error):
        return None
    owner = function.__qualname__.partition(".")[0]
    is_method = "self" in known.parameters and args
    if is_method and owner not in [each.__name__ for each in type(args[0]).__mro__]:
        return TypeError(f"{name}() is called on a {owner}, not on {shortened(repr(args[0]))}")
    try:
        bound = known.bind(*args, **given).arguments
    except TypeError as wrong:
        return TypeError(f"{name}(): {wrong}")
    for parameter, value in bound.items():
        kinds = _kinds(known.parameters[parameter].annotation, function.__globals__, public)
        if kinds and not _is_one(value, kinds):
            if {*kinds} >= {"str", "PathLike"}:
                # Paths may be texts, and so are names.
                kinds["str"] = (str, "a name") if "Mapping" in kinds else kinds["PathLike"]
            shown = listed([*dict.fromkeys(words for _, words in kinds.values())], "or")
            return TypeError(f"{parameter} must be {shown}, not {shortened(repr(value))}")
    return None


def _is_one(value: Any, kinds: Mapping[str, tuple[Any, str]]) -> bool:
    # Of protocols and typed dictionaries, Python does not say.
    with suppress(TypeError):
        is_one = isinstance(value, tuple(kind for kind, _ in kinds.values()))
        return is_one and not (isinstance(value, str) and {*kinds}.isdisjoint(("str", "PathLike")))
    return True


def _is_told(error: Exception) -> bool:
    """Return whether this package raises an error, and not Python, a library or an assertion."""
    if isinstance(error, AssertionError):
        return False
    trace: Any = error.__traceback__
    while trace.tb_next is not None:
        trace = trace.tb_next
    code = trace.tb_frame.f_code
    is_ours = Path(code.co_filename).is_relative_to(Path(__file__).parents[1])
    return is_ours and opname[code.co_code[trace.tb_lasti]] == "RAISE_VARARGS"


_TYPES: dict[str, tuple[Any, str]] = {
    "int": (Integral, "a whole number"),
    "float": (Real, "a number"),
    "bool": (bool, "True or False"),
    "str": (str, "a text"),
    "PathLike": (PathLike, "a path"),
    "Path": (PathLike, "a path"),
    "Iterable": (Iterable, "several in a list"),
    "Sequence": (Sequence, "several in a list"),
    "Mapping": (Mapping, "a mapping"),
    "Callable": (Callable, "a function"),
    "None": (NoneType, "None"),
}
"""The types of arguments, by their names in annotations, and what they are called."""


def _kinds(annotation: Any, scope: Mapping[str, Any], public: Any) -> dict[str, tuple[Any, str]]:
    """Return the types of an argument by their names; none if one of them is not known."""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    while text != (text := re.sub(r"\[[^][]*\]|['\"]", "", text)):
        pass
    kinds: dict[str, tuple[Any, str]] = {}
    for each in (name.strip().rpartition(".")[2] for name in text.split("|")):
        ours = getattr(public, each) if each in public.__all__ else scope.get(each)
        if each in _TYPES:
            kinds[each] = _TYPES[each]
        elif isinstance(ours, UnionType):
            kinds |= _kinds(ours, scope, public)
        elif isinstance(ours, type):
            article = "an" if each[0] in "AEIO" else "a"
            kinds[each] = (ours, f"{article} {each.replace('GridWorld', 'Level')}")
        else:
            return {}
    return kinds


BEST, RANDOM = "best", "random"
NAMED = (BEST, RANDOM, "uniform")
"""The agents that have names."""

AGENTS = (
    f"`{'`, `'.join(NAMED)}`, a policy (.json, .npy, .npz), a model (.zip), or what a Python file "
    "calls by a name (agent.py:name)"
)
"""What a text names that is an agent."""


def is_agent(given: Any) -> bool:
    """Return whether an argument that is no text is a function, a model, or has a memory."""
    return callable(given) or any(hasattr(given, each) for each in ("predict", "act"))


def _looks_like_agent(given: Any) -> bool:
    """Return whether an argument is one that stands for an agent, and not for a level."""
    if isinstance(given, str):
        return given in NAMED or bool(re.search(r"\.(npy|npz|zip|py(:\w+)?)$", given))
    return is_agent(given) or hasattr(given, "dtype") or hasattr(given, "policy")


def no_format(name: str, known: Iterable[str]) -> str:
    """Return the message that there is no format of a name."""
    if not name:
        return f"the name of the file has no suffix that tells the format: {', '.join(known)}"
    return f"there is no format {name!r}, but {', '.join(known)}{did_you_mean(name, known)}"


def check_choice(name: str, value: Any, choices: Collection[str]) -> None:
    """Raise a ValueError if an argument is not one of its choices."""
    if not isinstance(value, str) or value not in choices:
        known = ", ".join(map(repr, choices))
        guess = did_you_mean(str(value), choices)
        raise ValueError(f"{name} must be one of {known}, not {value!r}{guess}")


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean …?` with the nearest known name, or an empty text."""
    found = nearest(name, known, 1)
    return f"; did you mean `{found[0]}`?" if found else ""
