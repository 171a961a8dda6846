"""What holds of every environment: all levels, all observations, all sets of actions."""

from __future__ import annotations

import copy
import pickle
import random
from itertools import compress
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import error, spaces
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env
from support.playing import Env, each_level_and, episodes, level_named, plain, walk, way_out

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.mdp.actions import Action

LEVEL_ID = "babyrobot/Level-v0"
MAX_WAY = 20_000


@each_level_and(("observation", [*OBSERVATIONS]), ("actions", [*ACTION_SETS]))
class TestLevels:
    """What holds of the environment of a level, with an observation and a set of actions."""

    def make(self, name: str, observation: str, actions: str) -> Env:
        """Return the environment as users make it, with Gymnasium's own checks around it."""
        return gymnasium.make(LEVEL_ID, level=level_named(name), **arguments(observation, actions))

    @pytest.fixture
    def env(self, name: str, observation: str, actions: str) -> Env:
        return self.make(name, observation, actions)

    @pytest.fixture
    def bare(self, env: Env) -> Env:
        """The environment without wrappers."""
        return env.unwrapped

    def test_gymnasiums_checker_is_content(self, bare: Env, observation: str) -> None:
        check_env(bare, skip_render_check=observation != "position")

    def test_spaces_contain_what_they_should(self, bare: Env, actions: str) -> None:
        space = bare.observation_space
        observation, _ = bare.reset(seed=1)
        for _ in range(25):
            assert observation in space
            if isinstance(space, spaces.Discrete):
                assert type(observation) is int
            else:
                assert isinstance(observation, np.ndarray)
                assert (observation.dtype, observation.shape) == (space.dtype, space.shape)
            observation, *_ = bare.step(bare.action_space.sample())
        assert isinstance(bare.action_space, spaces.Discrete)
        plain_space: spaces.Discrete[Any] = spaces.Discrete(count_of(actions))
        assert bare.action_space == plain_space
        assert plain_space == bare.action_space

    def test_masks_say_what_is_possible(self, bare: Env, actions: str) -> None:
        _, info = bare.reset(seed=2)
        first = ACTION_SETS[actions].first
        for _ in range(25):
            mask = info["action_mask"]
            assert (mask.dtype, mask.shape) == (np.int8, (count_of(actions),))
            assert mask.tolist() == bare.get_wrapper_attr("action_masks")().tolist()
            state = bare.get_wrapper_attr("_state")
            table = ACTION_SETS[actions].tables(bare.get_wrapper_attr("level"))
            assert mask.tolist() == table.action_mask[state, first:].tolist()
            if first == 0:
                assert mask[Action.STAY] == 1
            if mask.any():
                assert mask[bare.action_space.sample(mask)] == 1
            *_, info = bare.step(bare.action_space.sample())

    def test_sampled_actions_are_all_those_that_are_possible(self, bare: Env, actions: str) -> None:
        bare.action_space.seed(3)
        _, info = bare.reset(seed=3)
        for _ in range(3):
            sampled = {int(bare.action_space.sample()) for _ in range(100)}
            mask = info["action_mask"]
            if not actions.startswith("valid"):
                mask = np.ones_like(mask)
            # Where nothing is possible, the space gives its first action.
            assert sampled == (set(mask.nonzero()[0].tolist()) or {0})
            *_, info = bare.step(bare.action_space.sample())

    def test_what_is_returned_belongs_to_the_user(
        self, name: str, observation: str, actions: str
    ) -> None:
        ours, theirs = (self.make(name, observation, actions).unwrapped for _ in range(2))
        assert episodes(ours, 4) == episodes(theirs, 4, spoiling=True)

    def test_rewards_and_ends(self, bare: Env) -> None:
        bare.reset(seed=5)
        for _ in range(25):
            table = bare.get_wrapper_attr("P")
            action, before = int(bare.action_space.sample()), bare.get_wrapper_attr("_state")
            _, reward, terminated, truncated, info = bare.step(action)
            state = bare.get_wrapper_attr("_state")
            outcomes = [outcome[1:] for outcome in table[before][action]]
            assert (state, reward, terminated) in outcomes
            assert type(reward) is float
            assert type(terminated) is bool
            assert truncated is False
            assert type(info["target_reached"]) is bool
            assert type(info["skidded"]) is bool

    def test_infos_are_the_same_numbers_at_reset_and_step(self, bare: Any, actions: str) -> None:
        _, info = bare.reset(seed=18)
        level = bare.level
        kinds: dict[str, Any] = {"action_mask": (np.int8, (count_of(actions),))}
        kinds |= {"target_reached": bool, "skidded": bool}
        kinds |= {"held": (np.bool_, (len(level.items),))} if level.items else {}
        kinds |= {"hit": bool} if level.movers else {}
        kinds |= {"maze_seed": int} if brl.load(bare.spec.kwargs["level"]).has_random_maze else {}
        assert not any(info[key] for key in ("target_reached", "skidded", "hit") if key in info)
        for _ in range(25):
            assert {key: kind_of(value) for key, value in info.items()} == kinds
            if level.items:
                now = level.configuration(bare._mdp.configuration(bare._state))
                assert tuple(compress(bare.item_names, info["held"])) == now.held
            *_, info = bare.step(bare.action_space.sample())
        assert bare.level_digest == level.digest

    def test_after_the_end_nothing_happens(self, bare: Env, actions: str) -> None:
        observation, _ = bare.reset(seed=6)
        policy = way_out(bare.get_wrapper_attr("P"))
        state = bare.get_wrapper_attr("_state")
        if state not in policy:
            level = bare.get_wrapper_attr("level")
            first_move = 2 if actions == "turns" else 1 - ACTION_SETS[actions].first
            assert level.exit == "none" or not any(mask_of(bare)[first_move:])
            return
        for _ in range(MAX_WAY):
            observation, _, terminated, _, _ = bare.step(policy[state])
            state = bare.get_wrapper_attr("_state")
            if terminated and not bare.get_wrapper_attr("_mdp").is_terminal[state]:
                # A mover hit the robot where, at other times, it could go on.
                bare.reset()
                state = bare.get_wrapper_attr("_state")
            elif terminated:
                break
        assert terminated
        for action in range(len(mask_of(bare))):
            after, reward, terminated, truncated, info = bare.step(action)
            assert plain(after) == plain(observation)
            assert (reward, terminated, truncated) == (0.0, True, False)
            stays = [1, 1] if actions == "turns" else [1]
            moves = [0] * (1 if actions == "turns" else 4)
            assert info["action_mask"].tolist() == [*stays, *moves][ACTION_SETS[actions].first :]

    def test_the_same_seed_gives_the_same_episodes(
        self, env: Env, name: str, observation: str, actions: str
    ) -> None:
        first = episodes(env, 7)
        assert episodes(env, 7) == first
        assert episodes(self.make(name, observation, actions), 7) == first

    def test_a_reset_without_a_seed_goes_on_with_the_generator(self, bare: Env) -> None:
        bare.reset(seed=8)
        generator = bare.np_random
        walk(bare, 10)
        before = copy.deepcopy(generator.bit_generator.state)
        _, info = bare.reset()
        assert bare.np_random is generator
        drawn = generator.bit_generator.state != before
        several = int((bare.get_wrapper_attr("initial_state_distrib") > 0).sum()) > 1
        assert drawn is (several or "maze_seed" in info)

    def test_nothing_can_be_done_before_the_first_reset(self, env: Env, bare: Env) -> None:
        for asked in (env, bare):
            with pytest.raises(error.ResetNeeded, match="reset"):
                asked.step(0)
        with pytest.raises(error.ResetNeeded, match="reset"):
            bare.get_wrapper_attr("action_masks")()

    def test_invalid_actions_are_refused_and_change_nothing(self, bare: Env, actions: str) -> None:
        count = count_of(actions)
        bare.action_space.seed(9)
        bare.reset(seed=9)
        before = copy.deepcopy(bare)
        for action in (-1, count, 2.5, "n", None, [1], np.array([1, 2]), np.float64(0.5), 10**30):
            with pytest.raises(error.InvalidAction, match=f"0 to {count - 1}"):
                bare.step(action)
        assert walk(bare, 10) == walk(before, 10)

    def test_numbers_of_all_sorts_are_actions(self, bare: Env) -> None:
        seen = []
        for action in (1, np.int64(1), np.uint8(1), np.array(1), Action(1)):
            bare.reset(seed=10)
            seen.append([plain(part) for part in bare.step(action)[:4]])
        assert seen == [seen[0]] * len(seen)

    def test_global_generators_are_left_alone(
        self, name: str, observation: str, actions: str
    ) -> None:
        random.seed(11)
        np.random.seed(11)
        before = global_states()
        env = self.make(name, observation, actions)
        env.reset()
        walk(env, 10)
        assert global_states() == before

    def test_copies_go_on_with_the_same_episode(self, bare: Env) -> None:
        unbegun = pickle.loads(pickle.dumps(bare))
        told = episodes(bare, 12, 5)
        copied, pickled = copy.deepcopy(bare), pickle.loads(pickle.dumps(bare))
        rest = walk(bare, 15)
        assert walk(copied, 15) == rest
        assert walk(pickled, 15) == rest
        assert episodes(unbegun, 12, 5) == told

    def test_the_spec_as_json_makes_the_same_game(self, env: Env) -> None:
        assert env.spec is not None
        again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
        assert again.observation_space == env.observation_space
        assert episodes(again, 13) == episodes(env, 13)


def count_of(actions: str) -> int:
    """Return how many actions a set has."""
    return {"moves": 4, "valid_moves": 4, "turns": 3}.get(actions, 5)


def arguments(observation: str, actions: str) -> dict[str, Any]:
    """Return the arguments of an environment; images are as small as levels can be seen in."""
    size = {"image_size": (12, 15)} if observation == "image" else {}
    return {"observation": observation, "actions": actions, **size}


def global_states() -> list[Any]:
    """Return the states of Python's and NumPy's global generators."""
    _, keys, position, *_ = np.random.get_state(legacy=True)
    return [random.getstate(), np.asarray(keys).tolist(), position]


def kind_of(value: Any) -> Any:
    """Return what kind of info a value is: its type, or dtype and shape of an array in C order."""
    if not isinstance(value, np.ndarray):
        return type(value)
    assert value.flags.carray
    return value.dtype, value.shape


def mask_of(env: Env) -> list[int]:
    """Return the action mask of where the robot stands."""
    masks: list[int] = env.get_wrapper_attr("action_masks")().tolist()
    return masks
