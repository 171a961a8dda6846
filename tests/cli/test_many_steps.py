"""Levels with a limit of millions of steps: figures or sentences, in seconds."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

import pytest
from support.sessions import environment, run_here

ENDLESS = "{version: 1, size: [2, 1], exit: none, rewards: {step: -1}, max_steps: 90000000}"
LARGE = "{version: 1, size: [6, 6], max_steps: 50000000}"


@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("preview endless.yaml -o page.html", "wrote page.html"),
        ("score best endless.yaml", "-9e+07  -9e+07   -9e+07"),
        ("solve endless.yaml --within max_steps", "expected return: -9e+07"),
        ("solve endless.yaml --within max_steps --format json", "is too large for JSON"),
        ("solve large.yaml --within max_steps", "within 50,000,000 steps is too large"),
    ],
)
def test_commands_answer_in_time(
    command: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "endless.yaml").write_text(ENDLESS, "utf-8")
    (tmp_path / "large.yaml").write_text(LARGE, "utf-8")
    begin = perf_counter()
    done = run_here(command.split(), environment(tmp_path))
    assert told in done.out + done.err
    assert perf_counter() - begin < 30
