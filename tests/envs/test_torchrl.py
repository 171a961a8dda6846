"""TorchRL takes all environments, with their masks. It brings torch: see `test_sb3.py`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium
import pytest
from gymnasium.vector import AutoresetMode

from babyrobot_levels.envs.observations import OBSERVATIONS

if TYPE_CHECKING:
    from torchrl.envs import EnvBase

pytestmark = [pytest.mark.libraries, pytest.mark.filterwarnings("ignore")]

IDS = ["final-maze", "frozen-lake", "random-maze", "first-key", "Suite"]
KINDS = [*OBSERVATIONS, ("position", "walls", "planes")]
# Every observation, every environment, and both sets of actions; not all with all.
CASES = [
    *(("first-key", observation, "all") for observation in KINDS),
    *((name, ("position", "walls", "planes"), "turns") for name in IDS),
]


def settings(name: str) -> dict[str, Any]:
    """Return what names an environment: all but suites have ids of their own."""
    if name == "Suite":
        return {"id": "babyrobot/Suite-v0", "suite": "small-mazes"}
    return {"id": f"babyrobot/{name}-v0", "max_episode_steps": 20}


def single(name: str, **kwargs: Any) -> EnvBase:
    import torch
    from torchrl.data import Binary
    from torchrl.envs import GymEnv, default_info_dict_reader

    chosen = settings(name)
    env = GymEnv(chosen.pop("id"), categorical_action_encoding=True, **chosen, **kwargs)
    masks = Binary(env.action_spec.n, dtype=torch.int8)
    return env.set_info_dict_reader(default_info_dict_reader(["action_mask"], spec=[masks]))


def batch(name: str, num_envs: int = 3, **kwargs: Any) -> EnvBase:
    from torchrl.envs import GymWrapper

    mode = AutoresetMode.DISABLED
    envs = gymnasium.make_vec(**settings(name), num_envs=num_envs, autoreset_mode=mode, **kwargs)
    return GymWrapper(envs, categorical_action_encoding=True).auto_register_info_dict()


@pytest.mark.parametrize(("name", "observation", "actions"), CASES, ids=str)
@pytest.mark.parametrize("make", [single, batch])
def test_its_checker_is_content(make: Any, name: str, observation: Any, actions: str) -> None:
    from torchrl.envs.utils import check_env_specs

    check_env_specs(make(name, observation=observation, actions=actions), seed=1)


@pytest.mark.parametrize("make", [single, batch])
def test_it_masks_what_walls_refuse(make: Any) -> None:
    import torch
    from torchrl.envs import ActionMask, TransformedEnv

    torch.manual_seed(1)
    env = TransformedEnv(make("final-maze"), ActionMask())
    steps = env.rollout(20)
    masks = steps["action_mask"]
    assert not masks.all()
    assert masks.gather(-1, steps["action"].unsqueeze(-1)).all()


def test_it_resets_the_environments_that_are_over_and_no_others() -> None:
    import torch

    torch.manual_seed(1)
    env = batch("frozen-lake", num_envs=8, observation="index")
    steps = env.rollout(60, break_when_any_done=False)
    done = steps["next", "done"][:, :-1, 0]
    before, after = steps["next", "observation"][:, :-1], steps["observation"][:, 1:]
    assert {True, False} == set(done.any(dim=0).tolist())
    assert steps["next", "terminated"].any()
    assert steps["next", "truncated"].any()
    assert not after[done].any()  # the start is state 0
    assert torch.equal(before[~done], after[~done])
