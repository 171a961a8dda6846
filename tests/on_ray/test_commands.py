"""Commands on files: on a cluster they say the same as in one process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.sessions import Result, environment, run_here

BAD = "version: 1\nsize: [4, 4]\nexit: [9, 9]\n"
UNTIDY = "size: [4,4]\nversion: 1\n"


@pytest.mark.parametrize("command", [["validate"], ["lint"], ["format", "--check"]])
def test_files_are_checked_as_in_one_process(command: list[str], cluster: Any, here: Path) -> None:
    folder = here / "levels"
    folder.mkdir()
    for number in range(20):
        text = BAD if number == 7 else UNTIDY
        folder.joinpath(f"level-{number:02}.yaml").write_text(text, encoding="utf-8")

    def run(*more: str) -> Result:
        return run_here([*command, *more], environment(here))

    alone = run("--jobs", "1")
    assert alone.status == 1
    assert run("--ray-address", cluster.address) == alone
