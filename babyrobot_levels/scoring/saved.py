"""Agents from files: saved policies and models."""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from lzma import LZMAError
from pathlib import Path
from pkgutil import resolve_name
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.text.files import read_bytes

MAX_BYTES = 256 << 20
"""The most bytes of a saved policy."""

_MAX_HEAD = 16 << 20
"""The most bytes of what a model of Stable-Baselines3 says about itself."""

_FAULTS = (
    ValueError,
    TypeError,
    KeyError,
    RuntimeError,
    EOFError,
    TokenError,
    zipfile.BadZipFile,
    zlib.error,
    LZMAError,
)
"""What reading a file raises that is damaged, or of another kind."""

_MODELS = {
    "stable_baselines3.common.policies": "stable_baselines3:PPO",
    "stable_baselines3.dqn.policies": "stable_baselines3:DQN",
    "sb3_contrib.common.maskable.policies": "sb3_contrib:MaskablePPO",
    "sb3_contrib.common.recurrent.policies": "sb3_contrib:RecurrentPPO",
    "sb3_contrib.qrdqn.policies": "sb3_contrib:QRDQN",
}
"""The classes of models by the module of their policies. That of A2C is PPO's."""


class AgentError(ValueError):
    """A file from which no agent can be read. `help` says what to do."""

    def __init__(self, message: str, help_text: str | None = None):
        self.help = help_text
        super().__init__(message)


def load_policy(path: Path) -> Any:
    """Return a saved policy as `brl.score` takes it; no code of the file runs.

    Args:
        path: one of

            - `.json`: actions `[height, width]` or probabilities, a mapping from names or digests
              of levels to these, or what `babyrobot solve --format json` prints;
            - `.npy`: an array of these;
            - `.npz`: arrays by names or digests of levels.

    Raises:
        OSError: the file cannot be read.
        AgentError: it is none of these.
    """
    data = read_bytes(path, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise AgentError(f"{path}: the file is larger than {MAX_BYTES >> 20} MiB")
    try:
        found = _json_policy(data) if path.suffix.lower() == ".json" else _array_policy(data)
    except _FAULTS:
        raise AgentError(f"{path} is not a saved policy") from None
    tables = found.values() if isinstance(found, dict) else [found]
    if not all(table.dtype.kind in "iuf" for table in tables):
        raise AgentError(f"{path}: a policy is an array of actions or of probabilities")
    return found


def _json_policy(data: bytes) -> Any:
    found = json.loads(data)
    if not isinstance(found, dict):
        return np.array(found)
    if "policy" in found:
        return np.array(found.get("policies", found["policy"]))
    return {name: np.array(table) for name, table in found.items()}


def _array_policy(data: bytes) -> Any:
    if not data.startswith(b"PK"):
        return _array(data)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        if sum(each.file_size for each in archive.infolist()) > MAX_BYTES:
            raise ValueError("the arrays are too large")
        return {
            name.removesuffix(".npy"): _array(archive.read(name)) for name in archive.namelist()
        }


def _array(data: bytes) -> NDArray[Any]:
    """Return the array of a `.npy` file. NumPy makes room for what its header claims: look first.

    Raises:
        ValueError: it is none, has less than it claims, or has objects.
    """
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    read_header = (
        np.lib.format.read_array_header_1_0
        if version == (1, 0)
        else np.lib.format.read_array_header_2_0
    )
    shape, _, dtype = read_header(stream)
    if math.prod(shape) * dtype.itemsize > len(data):
        raise ValueError("the array has less than its header claims")
    return np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)


def load_model(path: Path) -> Any:
    """Return a model of Stable-Baselines3 or sb3-contrib. Code of the file runs: trust its author.

    Raises:
        OSError: the file cannot be read.
        AgentError: it is no model of these libraries, or they are not installed.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            if archive.getinfo("data").file_size > _MAX_HEAD:
                raise AgentError(f"{path} is not a model of Stable-Baselines3")
            head = json.loads(archive.read("data"))
        kind = _MODELS[head["policy_class"]["__module__"]]
    except _FAULTS:
        raise AgentError(f"{path} is not a model of Stable-Baselines3 or sb3-contrib") from None
    try:
        return resolve_name(kind).load(path, device="cpu")
    except ImportError as error:
        library = kind.partition(":")[0].replace("_", "-")
        raise AgentError(
            f"this model needs {library} ({error})", f"install it: pip install {library}"
        ) from None
