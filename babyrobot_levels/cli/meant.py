"""What people type who know other programs, and what it is called here."""

import json
import re
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from babyrobot_levels.cli.completion import TABLE
from babyrobot_levels.text.words import NAMED, did_you_mean, listed, nearest, words_beside

_WRITTEN = re.compile(r".+\.(png|svg|gif|pdf|html?|json|npz?|csv|txt)", re.I)
NO_LEVEL = re.compile(r".+\.(png|svg|gif|pdf|html?|np[yz]|csv|py|brlplay)", re.I)
"""Files that hold no level, even if there is one."""


def commands(word: str, known: Mapping[str, str], then: str = "") -> str:
    """Return what a word that is no command may mean.

    Args:
        word: the word.
        known: the commands, and what they do.
        then: the word behind it.
    """
    word, tables = word.lower(), words_beside(__file__)
    for words, told in tables["elsewhere"].items():
        if word in words.split():
            return f" {told[0].upper()}{told[1:]}."
    found = [command for command, words in tables["commands"].items() if word in words.split()]
    if found == ["--help"] and then in known:
        found = [f"{then} --help"]
    found = found or [each for each in known if word and each.startswith(word)]
    found = found or get_close_matches(word, known, cutoff=0.75)
    shown = (f"{each!r}{_does(known.get(each))}" for each in found)
    if found:
        return f" Did you mean {' or '.join(shown)}?"
    command = then if then in known else "preview" if "." in word else ""
    return f" The command comes first: `babyrobot {command} {word}`." if command else ""


def _does(summary: str | None) -> str:
    return f" ({summary[0].lower()}{summary[1:-1]})" if summary else ""


def option(name: str, known: Collection[str], words: Collection[str]) -> str:
    """Return what an option may mean that a command does not have.

    Args:
        name: the option.
        known: the options that the command has.
        words: what was typed.
    """
    whole = next((f"-{word}" for word in words if f"-{word}" in known), None)
    if whole and not name.startswith("--"):
        return f". Did you mean `{whole}`?"
    for ours, others in words_beside(__file__)["options"].items():
        if name in others.split() and (ours.split()[0] in known or not ours.startswith("-")):
            return f". Did you mean `{ours}`?"
    if nearest(name, known, 1, 0.75):
        return ""
    takes = json.loads(TABLE.read_text("utf-8"))["commands"]
    having = [f"`{command}`" for command, options in takes.items() if name in options]
    told = listed(having) if len(having) < 7 else f"{len(having)} other commands"
    return f". Leave it out: it is an option of {told}" if having else ""


def choice(word: str, known: tuple[str, ...] | str) -> str:
    """Return the question which of the known words is meant by one that is none of them."""
    from babyrobot_levels.language.messages import guessed

    return guessed(word, [known] if isinstance(known, str) else known).replace("; d", " D")


def extra(word: str, known: Mapping[str, Any], words: Collection[str]) -> str:
    """Return the question what a word means for which a command has no place.

    Args:
        word: the word.
        known: the options of the command.
        words: what was typed.
    """
    if word.isdecimal() and "--size" in known:
        return ". Did you mean `--size WIDTHxHEIGHT`?"
    is_alone = any(
        each.param_type_name == "argument" and each.nargs == 1 for each in known.values()
    )
    if is_alone and _is_level(word):
        return ". Call it once for each of them"
    likely = ("--tag", "--output") if "." in word else ("--tag", "--to", "--output")
    for name in likely:
        if name in known and not {*words}.intersection(known[name].opts):
            return f". Did you mean `{name} {word}`?"
    return ""


def _is_level(word: str) -> bool:
    from babyrobot_levels.library.catalogue import find

    with suppress(LookupError):
        return Path(word).is_file() or bool(find(word))
    return False


def tag(word: str, known: Iterable[str]) -> str:
    """Return the question what a tag means that no level has."""
    for ours, others in words_beside(__file__)["tags"].items():
        if word in others.split():
            return f"; did you mean `{ours}`?"
    return did_you_mean(word, known)


def argument(word: str, what: str, is_near: bool) -> str | None:
    """Return what to do where a word was given as a level or suite, and is none.

    `is_near` tells that there are such ones with a name like it.
    """
    is_file = word.endswith((".npy", ".npz", ".py", ".zip")) and Path(word).is_file()
    if word in NAMED or is_file:
        return f"an agent comes first: `babyrobot score {word} LEVEL`"
    if is_near:
        return None
    if what == "suite":
        return f"to write into a folder, give it as `-o {word}`"
    if "://" in word:
        return "a link of a level ends in its share code: `…#brl1.…`"
    if len(word) < 256 and Path(word).is_dir():
        return f"{word} is a folder: give one of its files"
    if _WRITTEN.fullmatch(word):
        return f"it holds no level; to write a file, give it as `-o {word}`"
    pack, _, name = word.partition("/")
    if not name or Path(pack).is_dir():
        return None
    return f"the levels of a pack {pack!r} can be used once `babyrobot install` has its file"
