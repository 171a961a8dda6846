"""Agents from files, and pictures of scores."""

from __future__ import annotations

import io
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.agents.agents import AgentError, load_model, load_policy

NAMES = ["frozen-lake", "first-key"]


class Bomb:
    """What no reader may unpickle."""

    def __reduce__(self) -> tuple[Any, ...]:
        return Path("ran").touch, ()


def header(shape: str) -> bytes:
    """Return a `.npy` file that has nothing but its header."""
    text = f"{{'descr': '<i8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\1\0" + len(text).to_bytes(2, "little") + text.encode()


def zipped(data: bytes) -> bytes:
    """Return a `.npz` file of one array."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("maze.npy", data)
    return stream.getvalue()


def test_the_output_of_solve_is_a_policy(tmp_path: Path) -> None:
    arguments = ["solve", "frozen-lake", "--within", "max_steps", "--format", "json"]
    (tmp_path / "solved.json").write_text(run_here(arguments, environment(tmp_path)).out)
    policy = load_policy(tmp_path / "solved.json")
    policies = brl.solve("frozen-lake", within="max_steps").policies
    assert policies is not None
    assert np.array_equal(policy, policies)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("bomb.npy", None),
        ("bomb.npz", pickle.dumps(Bomb())),
        ("empty.npy", b""),
        ("text.json", b"hello"),
        ("deep.json", b"[" * 100_000),
        ("ragged.json", b"[[1, 2], [3]]"),
        ("words.json", b'[["north"]]'),
        ("number.json", b'{"policy": "best"}'),
        ("zip.npz", b"PK\3\4 and no more"),
        ("claims.npy", header("(100000000000,)")),
        ("claims.npz", zipped(header("(100000, 100000, 100000)"))),
        ("damaged.npz", zipped(np.arange(999).tobytes()).replace(b"\3", b"\4")),
        ("brackets.npy", header("(((")),
    ],
)
def test_what_is_no_policy_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, data: bytes | None
) -> None:
    monkeypatch.chdir(tmp_path)
    if data is None:
        np.save(name, np.array([Bomb()], object), allow_pickle=True)
    else:
        Path(name).write_bytes(data)
    with pytest.raises(AgentError, match="policy"):
        load_policy(Path(name))
    assert not Path("ran").exists()


def test_models_say_of_which_class_they_are(tmp_path: Path) -> None:
    path = tmp_path / "model.zip"
    for head in (None, b"hello", b"{}", b'{"policy_class": {"__module__": "os"}}'):
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("data" if head else "other", head or b"")
        with pytest.raises(AgentError, match="is not a model of Stable-Baselines3 or sb3-contrib"):
            load_model(path)


@pytest.mark.libraries
@pytest.mark.parametrize("name", ["PPO", "A2C", "DQN", "MaskablePPO", "QRDQN"])
def test_models_come_back(tmp_path: Path, name: str) -> None:
    import sb3_contrib
    import stable_baselines3

    library = stable_baselines3 if hasattr(stable_baselines3, name) else sb3_contrib
    model = getattr(library, name)("MlpPolicy", brl.load("frozen-lake").make(), seed=3)
    model.save(tmp_path / "model.zip")
    loaded = load_model(tmp_path / "model.zip")
    assert [*brl.score("frozen-lake", loaded)] == [*brl.score("frozen-lake", model)]


# -- pictures --------------------------------------------------------------------------------
