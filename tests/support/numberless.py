"""The editor where there is neither NumPy nor SciPy, as in a browser: what it answers.

`python -m support.numberless` blocks both, reads questions as JSON and writes the answers as JSON.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import babyrobot_levels
from babyrobot_levels.mdp.numeric import LIBRARIES


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
    from babyrobot_levels.editor.sources import FORMS, session_of
    from support.gestures import send

    session = session_of(name)
    copies = {form: send(session, "copy", form=form) for form in FORMS if form != "link"}
    return {**send(session, "state")["state"], "copies": copies}


def texts_after(name: str, seed: int, count: int) -> list[Any]:
    """Return, after each of some random gestures, the text, or why it was refused."""
    from babyrobot_levels.editor.sources import session_of
    from support.gestures import random_gesture, send

    session, rng = session_of(name), Random(seed)
    told = []
    for _ in range(count):
        reply = send(session, **random_gesture(rng, session))
        told.append(reply.get("error", session.text))
    return told


def replies(text: str, messages: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the replies to messages about a text."""
    from babyrobot_levels.editor.session import Session
    from support.gestures import send

    session = Session(text)
    return [send(session, **message) for message in messages]


def asked(questions: list[tuple[str, list[Any]]], folder: Path) -> list[Any]:
    """Return what functions of this module, named, answer in an interpreter without NumPy."""
    from support.places import TESTS
    from support.subprocesses import python

    file = folder / "questions.json"
    file.write_text(json.dumps(questions), "utf-8")
    done = python("-m", "support.numberless", file, cwd=folder, path=TESTS)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    answers: list[Any] = json.loads(done.stdout)
    return answers


if __name__ == "__main__":
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
