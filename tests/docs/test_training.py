"""The page on training: its pieces of code run."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS, EXAMPLES

PAGE = (DOCS / "training.md").read_text(encoding="utf-8")
PIECES = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
LIBRARIES = ("minari", "tianshou")


def run(code: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(code, "training.md", "exec"), names)
    return names


def pieces(*names: str) -> list[str]:
    """The pieces of code that need one of these libraries."""
    return [code for code in PIECES if any(name in code for name in names)]


@pytest.mark.parametrize("code", sorted({*PIECES} - {*pieces("sb3", *LIBRARIES)}))
def test_what_needs_numpy_only(code: str) -> None:
    run(code)


@pytest.mark.sb3
@pytest.mark.parametrize("code", pieces("sb3"))
def test_what_needs_stable_baselines(code: str) -> None:
    import torch

    torch.set_num_threads(1)
    names = run(code)
    # Who never finds the exit gets -500.
    assert names.get("mean", 0) > -60


@pytest.mark.libraries
@pytest.mark.filterwarnings("ignore:.* is set to None:UserWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.filterwarnings("ignore:Implicitly cleaning up:ResourceWarning")
@pytest.mark.parametrize("code", pieces(*LIBRARIES))
def test_what_needs_other_libraries(
    code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    names = run(code)
    if "collector" in names:
        assert len(names["collector"].buffer) == 800
    else:
        assert len(names["dataset"]) == 10
        assert names["env"].unwrapped.level.digest == names["level"].digest


@pytest.mark.parametrize("code", PIECES)
def test_each_piece_stands_alone(code: str) -> None:
    # In the process of the tests, Gymnasium knows the levels anyway.
    assert re.search(r"^(import|from) babyrobot_levels\b", code, re.MULTILINE)


def test_the_page_names_all_examples() -> None:
    examples = {path.name for path in (EXAMPLES).glob("*.py")}
    named = set(re.findall(r"\.\./examples/(\w+\.py)", PAGE))
    assert named == examples - {"play.py", "arguments.py", "comparison.py"}
