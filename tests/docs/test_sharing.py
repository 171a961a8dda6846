"""The page on sharing: what it shows is what happens."""

from __future__ import annotations

import base64
import re
import zlib
from pathlib import Path
from typing import Any

from support.places import DOCS
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.language.share_dictionary import DICTIONARY_1
from babyrobot_levels.library.reading import load_code

TEXT = (DOCS / "sharing.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


def told(*arguments: str) -> str:
    return run_here(list(arguments), environment(Path.cwd())).out


def test_the_python_runs_and_says_what_stands_behind_it() -> None:
    names: dict[str, Any] = {}
    for block in blocks("python"):
        exec(block, names)
        for line in block.splitlines():
            shown = re.fullmatch(r"(\S.*\S)  # (True|\"sha256:[0-9a-f]+).*", line)
            if shown:
                value = eval(shown[1], names)
                assert str(value).startswith(shown[2].strip('"'))
    assert names["level"].name == "final-maze"
    assert names["env"].unwrapped.level_digest == names["level"].digest


def test_the_outputs_are_those_of_the_commands() -> None:
    difference, citation = blocks("text")
    assert told("show", "final-maze", "--cite") == citation
    pattern = ".*".join(map(re.escape, re.split(r" *…\n", difference)))
    assert re.fullmatch(pattern, told("diff", "maze", "maze-changed"), re.DOTALL)


def test_a_reader_without_dictionaries_can_use_a_stored_block() -> None:
    code = brl.load("final-maze").share_code()
    body = code.split(".")[2]
    stream = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))[4:]
    size = len(DICTIONARY_1)
    head = b"\0" + size.to_bytes(2, "little") + (size ^ 0xFFFF).to_bytes(2, "little")
    data = zlib.decompress(head + DICTIONARY_1 + stream, -15)[size:]
    assert brl.loads(data.decode()).digest == load_code(code).digest
