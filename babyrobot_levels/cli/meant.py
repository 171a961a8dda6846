"""What people type who know other programs, and what it is called here."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path

from babyrobot_levels.text.words import NAMED

COMMANDS = {
    "play": "run start step simulate walk game",
    "solve": "policy optimal optimise optimize plan best values value-iteration path solution",
    "validate": "check test verify",
    "lint --fix": "fix repair",
    "score": "grade evaluate mark bench benchmark eval rollout",
    "import": "convert load read",
    "export": "convert save",
    "show": "info describe summary stats cat inspect details metrics difficulty",
    "preview": "render draw print view plot picture image svg png html page display screenshot "
    "visualize visualise",
    "preview LEVEL -o FILE.gif": "gif animate film movie video record",
    "replay": "watch",
    "edit": "open",
    "new-level": "new create init make touch",
    "generate": "make build grow batch random maze mazes",
    "generate --from LEVEL --difficulty A..B": "harder easier mutate vary",
    "share LEVEL -o FILE": "copy cp duplicate",
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
    "--install-completion": "completion completions",
}
"""Commands, and words that are none."""

ELSEWHERE = {
    "train learn fit": "`babyrobot solve` computes the optimum; in Python, `brl.q_learning(level)` "
    "and others learn it",
    "hint hints": "`babyrobot play LEVEL` gives hints: the key H",
    "config settings configure": "the settings of `babyrobot lint` stand in `pyproject.toml`",
    "docs tutorial manual guide": "`babyrobot COMMAND -h` explains a command, `babyrobot rule` all "
    "rules",
}
"""Words that are no commands, and what there is instead."""

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
    "--format": "--type --json --csv --output-format",
    "--to": "--format",
    "--difficulty A..B": "--max-difficulty --min-difficulty --metric --metrics",
    "babyrobot format": "--write --in-place",
    "babyrobot lint --fix": "--fix",
    "babyrobot lint": "--check",
    "babyrobot rule": "--list-rules --rules --explain",
    "brl.value_iteration(level)": "--algorithm --method",
    "--seed": "--random-state",
    "--theme": "--style --colors --colours --dark",
}
"""Options, and those of other programs; a command has some of them, and others are elsewhere."""

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
    word = word.lower()
    for words, told in ELSEWHERE.items():
        if word in words.split():
            return f" {told[0].upper()}{told[1:]}."
    found = [command for command, words in COMMANDS.items() if word in words.split()]
    if found == ["--help"] and then in known:
        found = [f"{then} --help"]
    found = found or [each for each in known if word and each.startswith(word)]
    found = found or get_close_matches(word, known, cutoff=0.75)
    shown = (f"{each!r}{_does(known.get(each))}" for each in found)
    return f" Did you mean {' or '.join(shown)}?" if found else ""


def _does(summary: str | None) -> str:
    return f" ({summary[0].lower()}{summary[1:-1]})" if summary else ""


def option(name: str, known: Iterable[str]) -> str | None:
    """Return the option of a command that one of another program means, if there is one."""
    known = {*known}
    for ours, others in OPTIONS.items():
        if name in others.split() and (ours.split()[0] in known or not ours.startswith("-")):
            return f"`{ours}`"
    return None


def extra(word: str, known: Iterable[str]) -> str:
    """Return the question what a word means for which a command has no place."""
    known = {*known}
    likely = ("--tag", "--output") if "." in word else ("--tag", "--to", "--output")
    options = [each for each in likely if each in known]
    return f". Did you mean `{options[0]} {word}`?" if options else ""


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
    if _WRITTEN.fullmatch(word):
        return f"to write a file, give it as `-o {word}`"
    pack, _, name = word.partition("/")
    if not name or Path(pack).is_dir():
        return None
    return f"the levels of a pack {pack!r} can be used once `babyrobot install` has its file"
