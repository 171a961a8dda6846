"""Agents in all forms that scoring takes, as functions from observations to probabilities.

An agent without memory answers an observation always alike, so what it does in every state of a
level is a table, from which its worth follows exactly. Only agents with memory have to be played.
"""

import ast
import inspect
import io
import json
import math
import sys
import zipfile
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from lzma import LZMAError
from os import PathLike
from pathlib import Path
from pkgutil import resolve_name
from runpy import run_path
from tokenize import TokenError
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.remembering import Player
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text.files import open_zip, read_bytes
from babyrobot_levels.text.words import AGENTS, NAMED, did_you_mean, listed, shortened


class Chooser(Protocol):
    """An agent without memory, for many observations at once."""

    def __call__(self, observations: Any, masks: NDArray[np.int8]) -> Floats:
        """Return the probability of each action, `[observations, actions]`.

        Args:
            observations: stacked along the first axis; a dict of such arrays for a `Dict` space.
            masks: which actions do not only bump into a wall, `[observations, actions]`.
        """


@dataclass(frozen=True, eq=False)
class Table:
    """A policy by states, as `brl.evaluate` takes it: it needs no observations.

    Attributes:
        policy: the policy of a level, or a mapping from names or digests of levels to policies.
    """

    policy: Any

    def of(self, name: str | None, digest: str) -> Any:
        """Return the policy of a level.

        Raises:
            ValueError: the mapping has none.
        """
        if not isinstance(self.policy, Mapping):
            return self.policy
        for key in (digest, name):
            if key in self.policy:
                return self.policy[key]
        names = listed([shortened(key) for key in [*self.policy][:5] if ":" not in str(key)])
        others = f", but for {names}: a mapping has one for each level" if names else ""
        raise ValueError(f"the agent has no policy for the level {name or digest!r}{others}")


Agent = Table | Chooser | Player


def read_agent(
    agent: Any,
    num_actions: int,
    *,
    deterministic: bool = True,
    batched: bool = False,
    robots: int = 1,
) -> Agent:
    """Return an agent in one of three forms.

    Args:
        agent: as `brl.score` takes it.
        num_actions: the number of actions.
        robots: how many robots it moves, each with so many actions; what it does is then told by
            joint actions.
        deterministic: whether a model takes its most likely action, or samples.
        batched: whether a function takes many observations at once.

    Raises:
        TypeError: it is none that scoring knows.
        AgentError: it names a file that has none.
        OSError: the file cannot be read.
    """
    if isinstance(agent, str | PathLike) and agent not in NAMED:
        agent = load_agent(agent)
    if isinstance(agent, str | Mapping | np.ndarray | list | tuple) or hasattr(
        agent, "first_action"
    ):
        return Table(agent)
    if hasattr(agent, "forward_inference"):
        if robots > 1:
            raise TypeError("an RLModule moves one robot: give a function of the observation")
        return _rllib_module(agent, num_actions, deterministic)
    if hasattr(agent, "predict") and hasattr(agent, "policy"):
        return _stable_baselines(agent, num_actions, deterministic, robots)
    if isinstance(agent, Player):
        return agent
    if callable(agent):
        return _function(agent, num_actions, batched, robots)
    raise TypeError(
        f"{type(agent).__name__} is no agent: give a policy, a function from observations to "
        "actions, a model of Stable-Baselines3 or RLlib, or an object with `reset` and `act`"
    )


# -- functions -----------------------------------------------------------------------------------


def _function(
    function: Callable[..., Any], num_actions: int, batched: bool, robots: int
) -> Chooser:
    with suppress(ValueError):  # Some functions do not tell their arguments.
        signature = inspect.signature(function)
        try:
            signature.bind(None)
        except TypeError:
            if isinstance(function, type):
                told = (
                    f"{function.__name__} is a class: give an object, as of {function.__name__}()"
                )
            else:
                told = (
                    f"an agent is called with the observation alone, and this one takes {signature}"
                )
            raise TypeError(told) from None

    def choose(observations: Any, masks: NDArray[np.int8]) -> Floats:
        if batched:
            return as_probabilities(function(observations), num_actions, len(masks), robots)
        answers = [function(_one(observations, index)) for index in range(len(masks))]
        return as_probabilities(np.array(answers), num_actions, len(masks), robots)

    return choose


def _one(observations: Any, index: int) -> Any:
    """Return one of stacked observations; a number for a `Discrete` space."""
    if isinstance(observations, dict):
        return {name: _one(each, index) for name, each in observations.items()}
    return observations[index]


class AnswerError(ValueError):
    """An answer of an agent that is none; `index` is the number of its observation."""

    def __init__(self, index: int, message: str):
        self.index = index
        super().__init__(message)


def as_probabilities(answers: Any, num_actions: int, count: int, robots: int = 1) -> Floats:
    """Return an agent's answers as probabilities, `[observations, actions]`.

    Args:
        answers: actions `[observations]`, or probabilities `[observations, actions]`; of several
            robots, also the action of each, `[observations, robots]`.
        num_actions: the number of actions of a robot.
        count: the number of observations.
        robots: the number of robots.

    Raises:
        AnswerError: they are neither.
    """
    table, joint = np.asarray(answers), num_actions**robots
    if robots > 1 and table.shape == (count, robots) and table.dtype.kind in "iu":
        bad = np.flatnonzero(((table < 0) | (table >= num_actions)).any(axis=1))
        if not bad.size:
            # Numbered as in the tables of several robots.
            powers = num_actions ** np.arange(robots - 1, -1, -1)
            found: Floats = np.eye(joint)[table.astype(np.intp) @ powers]
            return found
        raise AnswerError(int(bad[0]), _no_answer(table.tolist()[bad[0]], num_actions, robots))
    if table.shape == (count, joint) and table.dtype.kind in "fiu":
        return table.astype(np.float64)
    if robots == 1 and table.shape == (count, 1):
        table = table[:, 0]
    are_actions = table.shape == (count,) and table.dtype.kind in "iub"
    wrong = np.flatnonzero((table < 0) | (table >= joint)) if are_actions else np.zeros(1, int)
    if count and len(wrong):
        answer = table.tolist()[wrong[0]] if table.ndim else table.item()
        raise AnswerError(int(wrong[0]), _no_answer(answer, num_actions, robots))
    return np.eye(joint)[table.astype(np.intp)]


def _no_answer(answer: Any, num_actions: int, robots: int) -> str:
    """Return the message about an answer that is none."""
    each = f" of each of the {robots} robots" if robots > 1 else ""
    return (
        f"an agent's answer must be an action from 0 to {num_actions - 1}{each}, or "
        f"{num_actions**robots} probabilities, not {answer!r}"
    )


# -- models of libraries -------------------------------------------------------------------------


def _stable_baselines(model: Any, num_actions: int, deterministic: bool, robots: int) -> Agent:
    """Return a model of Stable-Baselines3 or sb3-contrib."""
    if hasattr(model.policy, "lstm_actor"):
        return _Recurrent(model, deterministic)
    has_masks = "action_masks" in model.predict.__code__.co_varnames

    def choose(observations: Any, masks: NDArray[np.int8]) -> Floats:
        more = {"action_masks": _masks_of_each(masks, num_actions, robots)} if has_masks else {}
        if deterministic or not hasattr(model.policy, "get_distribution"):
            actions, _ = model.predict(observations, deterministic=True, **more)
            return as_probabilities(actions, num_actions, len(masks), robots)
        tensors, _ = model.policy.obs_to_tensor(observations)
        found = model.policy.get_distribution(tensors, **more)
        # sb3-contrib calls those of several robots by another name.
        found = getattr(found, "distributions", None) or found.distribution
        chances = np.ones((len(masks), 1))
        for each in found if isinstance(found, list) else [found]:
            own = np.asarray(each.probs.detach().cpu().numpy(), np.float64)
            chances = (chances[:, :, None] * own[:, None, :]).reshape(len(masks), -1)
        return chances

    return choose


def _masks_of_each(masks: NDArray[np.int8], num_actions: int, robots: int) -> NDArray[np.bool_]:
    """Return masks of joint actions as those of each robot, one after the other."""
    joint = masks.astype(bool).reshape(len(masks), *[num_actions] * robots)
    axes = range(1, robots + 1)
    return np.hstack([joint.any(axis=tuple({*axes} - {axis})) for axis in axes])


class _Recurrent:
    """A model of sb3-contrib with memory."""

    def __init__(self, model: Any, deterministic: bool) -> None:
        self._model, self._deterministic = model, deterministic
        self.reset()

    def reset(self) -> None:
        """Forget the episode before."""
        self._state: Any = None
        self._begins = True

    def act(self, observation: Any, mask: NDArray[np.int8]) -> Any:
        """Return the action for the next observation of an episode."""
        action, self._state = self._model.predict(
            observation,
            state=self._state,
            episode_start=np.array([self._begins]),
            deterministic=self._deterministic,
        )
        self._begins = False
        return action if np.ndim(action) else int(action)


def _rllib_module(module: Any, num_actions: int, deterministic: bool) -> Chooser:
    """Return an `RLModule` of RLlib, whose outputs are the logits of the actions.

    Raises:
        TypeError: it has memory.
    """
    if module.is_stateful():
        raise TypeError(
            "an RLModule with memory has to be played: give an object with `reset` and `act`"
        )
    import torch
    from gymnasium.spaces import Dict

    has_masks = isinstance(module.observation_space, Dict)
    space = module.observation_space["observations"] if has_masks else module.observation_space

    def choose(observations: Any, masks: NDArray[np.int8]) -> Floats:
        # A module can have been trained with flattened observations.
        given = torch.as_tensor(observations, dtype=torch.float32).reshape(-1, *space.shape)
        if has_masks:
            allowed = torch.as_tensor(masks, dtype=torch.float32)
            given = {"action_mask": allowed, "observations": given}
        with torch.no_grad():
            logits = module.forward_inference({"obs": given})["action_dist_inputs"]
            if deterministic:
                return as_probabilities(logits.argmax(dim=1).numpy(), num_actions, len(masks))
            return np.asarray(logits.softmax(dim=1).double().numpy(), np.float64)

    return choose


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
    """A word that names no agent, or a file that has none. `help` says what to do."""

    def __init__(self, message: str, help_text: str | None = None):
        self.message, self.help = message, help_text
        super().__init__(message if help_text is None else f"{message.rstrip('?')}; {help_text}")


def load_agent(given: str | PathLike[str], *, trust: bool = False) -> Any:
    """Return the agent that a text names, which is no name of `NAMED`: one in a file.

    Args:
        given: the path of a saved policy or model; or that of a Python file, which is run, and the
            name of a function in it: `agent.py:name`.
        trust: whether to load a model, although its file can run any code.

    Raises:
        OSError: the file cannot be read.
        AgentError: it has none.
    """
    text = str(given)
    file, _, name = text.rpartition(":")
    path, suffix = Path(text), Path(text).suffix.lower()
    if file.endswith(".py") or suffix == ".py":
        return _function_of(Path(file), name) if file.endswith(".py") else _function_of(path, "")
    if suffix in (".json", ".npy", ".npz"):
        return load_policy(path)
    if suffix != ".zip":
        guess = did_you_mean(text, NAMED)
        raise AgentError(f"there is no agent {text!r}{guess}", f"an agent is {AGENTS}")
    path.stat()
    if trust:
        return load_model(path)
    raise AgentError(
        f"{text} is a model, and loading a model can run any code",
        "if you trust its author, load it by its library, such as `PPO.load(…)`",
    )


def _function_of(path: Path, name: str) -> Any:
    """Return what a Python file calls by a name; the file is run.

    Raises:
        OSError: the file cannot be read.
        AgentError: it has nothing of this name.
    """
    tree = ast.parse(read_bytes(path, MAX_BYTES), str(path))
    names = [each.name for each in tree.body if isinstance(each, ast.FunctionDef | ast.ClassDef)]
    written = listed([f"`{path}:{each}`" for each in names or ["name"]], "or")
    if not name:
        raise AgentError(f"{path} is a file of Python", f"name the agent in it: {written}")
    # It can import what stands beside it, but nothing is imported from there in place of a library:
    # what asks for modules that only other systems have has asked before.
    import multiprocessing.connection  # noqa: F401

    sys.path.append(str(path.parent.resolve()))
    found = run_path(str(path))
    if name not in found:
        raise AgentError(f"{path} has nothing called {name!r}", f"give {written}")
    return found[name]


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
    found = read_tables(data, str(path))
    tables = found.values() if isinstance(found, dict) else [found]
    if not all(table.dtype.kind in "iuf" for table in tables):
        raise AgentError(f"{path}: a policy is an array of actions or of probabilities")
    return found


def read_tables(data: bytes, name: str) -> NDArray[Any] | dict[str, NDArray[Any]]:
    """Return what is in a file such as `load_policy` takes, as one array, or several by names.

    Args:
        data: what is in it.
        name: its name; its suffix tells the format.

    Raises:
        AgentError: it has no arrays.
    """
    try:
        found = _json_policy(data) if name.lower().endswith(".json") else _array_policy(data)
    except _FAULTS:
        raise AgentError(f"{name} is not a saved policy") from None
    tables: NDArray[Any] | dict[str, NDArray[Any]] = found
    return tables


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
    with open_zip(io.BytesIO(data)) as archive:
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
