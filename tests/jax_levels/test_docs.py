"""The page on JAX names the examples, and the notebook learns."""

from __future__ import annotations

import json
import re
from typing import Any

import jax
import pytest
from support.claims import says
from support.places import DOCS, EXAMPLES, ROOT

import babyrobot_levels.jax as brl_jax

PAGE = (DOCS / "jax.md").read_text(encoding="utf-8")


def test_the_page_names_the_examples() -> None:
    named = set(re.findall(r"\.\./examples/(\w+)\.py", PAGE))
    assert named == {path.stem for path in EXAMPLES.glob("*jax*.py")}


def test_the_notebook_learns_the_optimum(capsys: pytest.CaptureFixture[str]) -> None:
    cells = json.loads((ROOT / "notebooks" / "jax.ipynb").read_text("utf-8"))["cells"]
    codes = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    names: dict[str, Any] = {}
    exec(compile("\n".join(codes), "jax.ipynb", "exec"), names)
    assert names["shares"][-1].mean() > 0.99
    stored = [
        "".join(output["text"])
        for cell in cells
        for output in cell.get("outputs", [])
        if output["output_type"] == "stream"
    ]
    # What is learned may differ between devices; what is counted or solved may not.
    printed = capsys.readouterr().out
    assert printed.startswith(stored[0])
    assert stored[2] in printed


def test_infos_tell_of_the_step_before_a_reset_but_for_the_mask() -> None:
    says(
        "jax",
        "`info` tells of the step before a reset: `final_observation`, `level_index`, "
        "`target_reached`, `skidded`, with items `held`, and with movers `hit`; only `action_mask` "
        "is after it.",
        "So where an episode is over, `level_index` is the number of its level, and the new "
        "state's `level` is that of the next one;",
        "| `env.step_env(key, state, action, params)` | takes an action only: observation, state, "
        "reward, terminated, info |",
    )
    levels = [
        {
            "version": 1,
            "size": [2 + number, 1],
            "items": [{"name": "key", "at": [1 + number, 0]}],
            "exit": "none",
            "areas": [{"at": [1 + number, 0], "ends": True}],
            "movers": [{"path": [[1 + number, 0], [1 + number, 0]]}],
        }
        for number in range(3)
    ]
    env, params = brl_jax.make(levels)
    key, others = jax.random.key(0), 0
    _, state = env.reset(key, params)
    step = jax.jit(env.step)
    for number in range(40):
        before = int(state.level)
        own = env.step_env(jax.random.key(number), state, 2, params)
        observed, state, _, terminated, truncated, info = step(
            jax.random.key(number), state, 2, params
        )
        assert int(info["level_index"]) == before
        assert info["final_observation"].tolist() == own[0].tolist()
        assert bool(info["target_reached"])
        assert info["action_mask"].tolist() == env.action_mask(state, params).tolist()
        assert (bool(own[3]), bool(truncated)) == (bool(terminated), False)
        assert bool(info["held"][0]) == bool(info["hit"]) == bool(terminated)
        if terminated:
            assert info["final_observation"][0] == before + 1
            assert observed[0] == 0
            others += int(state.level) != before
    assert others > 3
