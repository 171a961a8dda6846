"""TRL takes a world of text as an environment, calls its tools, and learns from its rewards."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from support.places import ROOT


def test_a_tiny_model_is_trained_for_some_updates(tmp_path: Path) -> None:
    script = ROOT / "examples" / "grpo_trl.py"
    done = subprocess.run(
        [sys.executable, str(script), "--steps", "2", "--generations", "3"],
        cwd=tmp_path,
        env={**os.environ, "HF_HUB_OFFLINE": "1", "TRL_EXPERIMENTAL_SILENCE": "1"},
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    rewards = re.findall(r"^mean reward of the \w+ 1 updates: (-?\d+\.\d\d)$", done.stdout, re.M)
    # At worst, all of eight steps are paid, instead of one.
    assert len(rewards) == 2
    assert all(-7 <= float(reward) <= 0 for reward in rewards)
    calls = [float(each) for each in re.findall(r"call_frequency': '([\d.]+)'", done.stdout)]
    assert sum(calls) > 0
    assert re.search(r"failure_frequency': '0'", done.stdout)
