"""The page on the Python interface: each command has its function, and what that returns."""

from __future__ import annotations

import builtins
import inspect
import re

from support.places import DOCS

import babyrobot_levels as brl
from babyrobot_levels.cli.commands import COMMANDS

ROWS = re.findall(
    r"^\| `babyrobot ([\w-]+)` \| `brl\.(\w+)` \| (.*) \|$",
    (DOCS / "api" / "index.md").read_text("utf-8"),
    re.MULTILINE,
)

UNLIKE = {"list": "levels", "import": "import_"}
"""The functions that cannot have the name of their command."""


def test_each_command_is_a_function_of_its_name() -> None:
    assert [command for command, _, _ in ROWS] == list(COMMANDS)
    for command, name, returned in ROWS:
        assert name == UNLIKE.get(command, command.replace("-", "_"))
        assert name in brl.__all__
        annotation = inspect.signature(getattr(brl, name)).return_annotation
        assert returned.replace("`", "").replace(" or ", " | ") == annotation


def test_what_a_function_raises_can_be_caught_by_a_public_name() -> None:
    for name in brl.__all__:
        named = re.findall(
            r"^ *(\w+Error):", inspect.getdoc(getattr(brl, name)) or "", re.MULTILINE
        )
        assert {each for each in named if not hasattr(builtins, each)} <= {*brl.__all__}, name
