"""Completion in shells: of commands, options, and the names of what there is.

Shells wait for it at each Tab. So it imports nothing that makes commands: what these take is in a
file made from them (`scripts/renew.py`), and levels are known by their files.
"""

import json
import os
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

VARIABLE = "_BABYROBOT_COMPLETE"
TABLE = Path(__file__).with_suffix(".json")
"""What commands take: for each argument (`""`) and option the words, or their kind; null: none."""

_MOST = 1 << 20
"""The most bytes that are read of a file."""

_SUITE = re.compile(rb"^kind:[ \t]*[\"']?suite\b", re.MULTILINE)


def complete() -> bool:
    """Write what a shell asks for. Return False for a shell that typer answers."""
    shell = os.environ[VARIABLE].removeprefix("complete_")
    if shell not in ("bash", "zsh", "fish"):
        return False
    words, word = _typed(shell)
    found = sorted({each for each in candidates(words, word) if each.startswith(word)})
    if os.environ.get("_TYPER_COMPLETE_FISH_ACTION") == "is-args":
        sys.exit(not found)
    text = "\n".join(found)
    if shell == "zsh":
        quoted = "\n".join(f'"{each}"' for each in found)
        text = f"_arguments '*: :(({quoted}))'" if found else "_files"
    sys.stdout.write(f"{text}\n")
    return True


def _typed(shell: str) -> tuple[list[str], str]:
    """Return the words after the program's name, and the one that is to be completed."""
    line = os.environ.get("COMP_WORDS" if shell == "bash" else "_TYPER_COMPLETE_ARGS", "")
    _, *words = _split(line) or [""]
    is_last = len(words) == int(os.environ.get("COMP_CWORD", 0)) or shell != "bash"
    word = words.pop() if words and is_last and not line.endswith(" ") else ""
    # Bash takes `--theme=blue` for three words.
    return [each for each in words if each != "="], word.removeprefix("=")


def _split(line: str) -> list[str]:
    """Return the words of a line, the last of which may lack its closing quote."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=False)
    lexer.whitespace_split, lexer.commenters = True, ""
    words: list[str] = []
    try:
        words.extend(lexer)
    except ValueError:
        words.append(lexer.token)
    return words


def candidates(words: list[str], word: str) -> Iterator[str]:
    """Yield what can stand at the place of a word, whatever the word is.

    Args:
        words: the words before it, from the command on.
        word: the word.
    """
    table = json.loads(TABLE.read_text("utf-8"))
    if not words:
        yield from table["options"] if word.startswith("-") else table["commands"]
        return
    takes = table["commands"].get(words[0], {})
    option, equals, _ = word.partition("=")
    if equals and takes.get(option) is not None:
        yield from (f"{option}={each}" for each in _of(takes[option], table))
    elif words[1:] and words[-1].startswith("-") and takes.get(words[-1]) is not None:
        yield from _of(takes[words[-1]], table)
    elif word.startswith("-"):
        yield from (each for each in (*takes, "--help") if each)
    else:
        yield from _of(takes.get("", ""), table)


def _of(values: str | list[str], table: dict[str, dict[str, list[str]]]) -> Iterator[str]:
    """Yield words, those of a kind if it is a kind."""
    if isinstance(values, list):
        yield from values
    elif values in ("level", "levels", "suite", "pack"):
        yield from _names(values)
    else:
        yield from table["words"].get(values, ())


def _is_suite(path: Path) -> bool:
    """Return whether a file is a suite, judging by its text."""
    with suppress(OSError):
        if path.is_file():
            with path.open("rb") as file:
                return _SUITE.search(file.read(_MOST)) is not None
    return False


def _names(kind: str) -> Iterator[str]:
    """Yield the names of one level (`level`), of what stands for several (`levels`), and so on."""
    from babyrobot_levels.language.names import slug
    from babyrobot_levels.library.search_path import places, yaml_files

    for place in places():
        if place.pack is not None and kind in ("levels", "pack"):
            yield place.pack
        for path in yaml_files(place.folder) if kind != "pack" else ():
            if kind == "levels" or _is_suite(path) == (kind == "suite"):
                yield place.named(slug(path.stem) or "")
