"""The page on training: its pieces of code run."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS, EXAMPLES

PAGE = (DOCS / "training.md").read_text(encoding="utf-8")
PIECES = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def run(code: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(code, "training.md", "exec"), names)
    return names


LIBRARIES = {
    name: [code for code in PIECES if re.search(f"^(import|from) ({name})", code, re.MULTILINE)]
    for name in ("stable_baselines3|sb3_contrib", "ray", "torchrl", "tianshou", "minari")
}


@pytest.mark.parametrize(
    "code", [code for code in PIECES if not any(code in each for each in LIBRARIES.values())]
)
def test_what_needs_numpy_only(code: str) -> None:
    run(code)


@pytest.mark.libraries
@pytest.mark.parametrize("code", LIBRARIES["stable_baselines3|sb3_contrib"])
def test_what_needs_stable_baselines(code: str) -> None:
    import torch

    torch.set_num_threads(1)
    names = run(code)
    # Who never finds the exit gets -500.
    assert names.get("mean", 0) > -60


@pytest.mark.libraries
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("code", LIBRARIES["ray"])
def test_what_needs_rllib(code: str) -> None:
    import ray
    import torch

    torch.set_num_threads(1)
    try:
        names = run(code)
    finally:
        ray.shutdown()
    if "learned" in names:
        assert names["learned"] == pytest.approx(names["optimum"])
    else:
        assert names["result"]["num_env_steps_sampled_lifetime"] >= 2048


@pytest.mark.libraries
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("code", LIBRARIES["torchrl"])
def test_what_needs_torchrl(code: str) -> None:
    names = run(code)
    assert names["steps"]["action_mask"].shape[-2:] == (100, 5)


@pytest.mark.libraries
@pytest.mark.parametrize("code", LIBRARIES["tianshou"])
def test_what_needs_tianshou(code: str) -> None:
    assert len(run(code)["collector"].buffer) == 800


@pytest.mark.libraries
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("code", LIBRARIES["minari"])
def test_what_needs_minari(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    names = run(code)
    assert len(names["dataset"]) == 10
    assert names["env"].unwrapped.level.digest == names["level"].digest


@pytest.mark.parametrize("code", PIECES)
def test_each_piece_stands_alone(code: str) -> None:
    # In the process of the tests, Gymnasium knows the levels anyway.
    assert re.search(r"^(import|from) babyrobot_levels\b", code, re.MULTILINE)


def test_the_page_names_all_examples() -> None:
    examples = {path.name for path in (EXAMPLES).glob("*.py")}
    named = set(re.findall(r"\.\./examples/(\w+\.py)", PAGE))
    assert named == examples - {"arguments.py", "cluster.py", "comparison.py", "play.py"}
