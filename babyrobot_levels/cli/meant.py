"""What people type who know other programs, and what it is called here."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

COMMANDS = {
    "play": "run start step simulate walk",
    "solve": "train learn policy optimal optimise optimize plan best values value-iteration",
    "validate": "check test verify",
    "lint --fix": "fix repair",
    "score": "grade evaluate mark bench benchmark eval rollout",
    "import": "convert load read",
    "export": "convert save",
    "show": "info describe summary stats cat inspect details",
    "preview": "render draw print view plot picture image svg png gif html page display",
    "edit": "open",
    "new-level": "new create init make touch",
    "generate": "make build grow batch random",
    "list": "levels ls tags search",
    "list --packs": "packs",
    "expect": "assert promise state claim",
    "list --suites": "suite suites",
    "rule": "rules explain error",
    "share": "link url code",
    "gallery": "publish site web serve website",
    "sheet": "worksheet exercise handout homework exam",
    "install": "upgrade update download get add",
    "uninstall": "remove delete rm",
    "format": "fmt tidy prettify",
    "diff": "changes",
    "--help": "help man usage",
    "--version": "version",
}
"""Commands, and words that are none."""

OPTIONS = {
    "--discount": "--gamma --discount-factor",
    "--count": "-n -c --number --num --num-levels --amount",
    "--output": "--out --file --to --save --dir --folder",
    "-o FILE.png": "--png --svg --gif --pdf --html",
    "--key": "--answers --solution --solutions",
    "--link": "--url --web",
    "--within": "--steps --horizon --max-steps --limit",
    "--size": "--width --height --dimensions",
    "--cell": "--size --width --height --zoom --pixels",
    "--jobs": "--workers --processes --parallel --threads",
    "--tag": "--filter --search --tags --category",
    "--format": "--type --json --csv",
    "--seed": "--random-state",
    "--theme": "--style --colors --colours --dark",
}
"""Options, and those of other programs; a command has some of them."""

_WRITTEN = re.compile(r".+\.(png|svg|gif|pdf|html?|json|npz?|csv|txt)", re.I)


def commands(word: str, known: Iterable[str]) -> list[str]:
    """Return the commands that a word that is none may mean."""
    known, word = [*known], word.lower()
    others = [command for command, words in COMMANDS.items() if word in words.split()]
    same_start = [each for each in known if word and each.startswith(word)]
    return others or same_start or get_close_matches(word, known)


def option(name: str, known: Iterable[str]) -> str | None:
    """Return the option of a command that one of another program means, if there is one."""
    known = {*known}
    for ours, others in OPTIONS.items():
        if name in others.split() and ours.split()[0] in known:
            return f"`{ours}`"
    return "`babyrobot lint --fix`" if name == "--fix" and known else None


def extra(word: str, known: Iterable[str]) -> str:
    """Return the question what a word means for which a command has no place."""
    known = {*known}
    options = [each for each in ("--tag", "--output") if each in known]
    return f". Did you mean `{options[0]} {word}`?" if options else ""


def argument(word: str, what: str, is_near: bool) -> str | None:
    """Return what to do where a word was given as a level or suite, and is none.

    `is_near` tells that there are such ones with a name like it.
    """
    if word in ("random", "best"):
        return f"an agent comes first: `babyrobot score {word} LEVEL`"
    if is_near:
        return None
    if what == "suite":
        return f"to write into a folder, give it as `-o {word}`"
    if _WRITTEN.fullmatch(word):
        return f"to write a file, give it as `-o {word}`"
    pack, _, name = word.partition("/")
    if not name or Path(pack).is_dir():
        return None
    return f"the levels of a pack {pack!r} can be used once `babyrobot install` has its file"
