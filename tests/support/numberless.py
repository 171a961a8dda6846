"""The editor as it is in a browser, without NumPy and SciPy or with them: what it answers.

`python -m support.numberless` blocks both, or all that a site of the editor lacks, reads questions
as JSON and writes the answers as JSON.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
import sys
from collections.abc import Iterable, Iterator
from importlib.abc import MetaPathFinder
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any
from unittest.mock import patch

import babyrobot_levels
from babyrobot_levels.extensions.editor.site import MORE, PACKAGES
from babyrobot_levels.mdp.numeric import LIBRARIES

TEXT = "version: 1\nsize: [4, 3]\nstart: [0, 0]\nexit: [3, 2]\n"
MESSAGES: list[dict[str, Any]] = [
    {"do": "state"},
    {"do": "answers"},
    {"do": "levels"},
    {"do": "filled", "brush": "small", "at": [1, 1]},
    {"do": "lift", "cells": [[0, 0], [1, 1]]},
    {"do": "stamp", "at": [2, 1]},
    *({"do": "copy", "form": form} for form in ("yaml", "drawing", "python", "code")),
    {"do": "text", "text": TEXT + "puddles: [[1, 1]]\nexits: [3, 2]\n"},
    {"do": "undo"},
    {"do": "redo"},
    {"do": "text", "text": TEXT + "maze: {seed: 1}\nareas: []\n"},
    {"do": "resize", "size": [5, 3], "shift": [0, 0]},
    {"do": "keep_maze"},
    {"do": "open", "source": "final-maze"},
    {"do": "open", "source": "SFFF\nFHFH\nFFFH\nHFFG\n"},
    {"do": "open", "source": "nothing-has-this-name"},
    {"do": "open", "source": "version: 1\nsize: [400, 400]\n" * 2},
    {"do": "open", "source": TEXT + "items: [{name: key, at: [1, 1]}]\nexit_needs: key\n"},
    {"do": "save"},
    {"do": "reload"},
    {"do": "downloaded"},
    {"do": "quit"},
]
NUMERIC: list[dict[str, Any]] = [
    {"do": "policy", "actions": [1] * 12},
    {"do": "copy", "form": "link"},
]


def modules_that_fail() -> Iterator[str]:
    """Yield the modules of the package that cannot be imported without what is blocked here."""
    for module in pkgutil.walk_packages(babyrobot_levels.__path__, "babyrobot_levels."):
        if not module.name.endswith("__main__"):
            try:
                importlib.import_module(module.name)
            except ImportError:
                yield module.name.removeprefix("babyrobot_levels.")


def state_of_level(name: str) -> Any:
    """Return what the editor shows of a level, and the copies that it makes."""
    from babyrobot_levels.extensions.editor.sources import FORMS, session_of
    from support.gestures import send

    session = session_of(name)
    copies = {form: send(session, "copy", form=form) for form in FORMS if form != "link"}
    return {**send(session, "state")["state"], "copies": copies}


def texts_after(name: str, seed: int, count: int) -> list[Any]:
    """Return, after each of some random gestures, the text, or why it was refused."""
    from babyrobot_levels.extensions.editor.sources import session_of
    from support.gestures import random_gesture, send

    session, rng = session_of(name), Random(seed)
    told = []
    for _ in range(count):
        reply = send(session, **random_gesture(rng, session))
        told.append(reply.get("error", session.text))
    return told


def replies(text: str, messages: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the replies to messages about a text."""
    from babyrobot_levels.extensions.editor.session import Session
    from support.gestures import send

    session = Session(text)
    return [send(session, **message) for message in messages]


def settled(message: dict[str, Any], reply: dict[str, Any]) -> dict[str, Any]:
    """Return a reply without what is at random, or depends on how fast the machine is."""
    late = {"answers", "findings", "findings_pending"} if message["do"] != "answers" else set()
    state = reply.get("state", {})
    return reply | {"state": {key: state[key] for key in state.keys() - late - {"number"}}}


class _Blocked(MetaPathFinder):
    """Finds no module that is neither Python's own nor of some packages."""

    def __init__(self, packages: Iterable[str]) -> None:
        self._known = {*packages, *sys.stdlib_module_names}

    def find_spec(self, fullname: str, *_: object) -> None:
        if fullname.partition(".")[0] not in self._known:
            raise ModuleNotFoundError(f"{fullname} is blocked", name=fullname)


def block_what_sites_lack() -> None:
    """Leave what a site has after NumPy and SciPy were loaded, and no threads."""

    def start(*_: object) -> None:
        raise RuntimeError("can't start new thread")

    patch.object(Thread, "start", start).start()
    own = ("pydantic", "pydantic_core", "support", *LIBRARIES)
    sys.meta_path.insert(0, _Blocked([*PACKAGES, *MORE, *own]))


def asked(
    questions: list[tuple[str, list[Any]]], folder: Path, *, is_numeric: bool = False
) -> list[Any]:
    """Return what functions of this module, named, answer in an interpreter without NumPy.

    Args:
        questions: the names of the functions, each with its arguments.
        folder: where there is room for a file.
        is_numeric: whether there are NumPy and SciPy, but nothing else that sites lack.
    """
    from support.places import TESTS
    from support.subprocesses import python

    file = folder / "questions.json"
    file.write_text(json.dumps(questions), "utf-8")
    done = python("-m", "support.numberless", file, str(is_numeric), cwd=folder, path=TESTS)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    answers: list[Any] = json.loads(done.stdout)
    return answers


if __name__ == "__main__":
    if sys.argv[2] == "True":
        block_what_sites_lack()
    else:
        for library in LIBRARIES:
            sys.modules[library] = None  # type: ignore[assignment]
    functions: dict[str, Any] = {
        "modules_that_fail": lambda: [*modules_that_fail()],
        "state_of_level": state_of_level,
        "texts_after": texts_after,
        "replies": replies,
    }
    given = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    sys.stdout.write(json.dumps([functions[name](*arguments) for name, arguments in given]))
