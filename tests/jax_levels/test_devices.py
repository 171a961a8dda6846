"""What needs another configuration of JAX: several devices, and numbers of 64 bits."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import babyrobot_levels

SEVERAL_DEVICES = """
import jax
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec
import babyrobot_levels.jax as brl_jax

devices = jax.devices()
assert len(devices) == 4
env, params = brl_jax.make(["bat-cave", "ice-vault", "frozen-lake"], observation="planes")

@jax.jit
def walk(params, keys):
    def one(state, keys):
        action = jax.vmap(env.sample_action, (0, 0, None))(keys, state, params)
        observed, state, reward, terminated, truncated, _ = jax.vmap(
            env.step, (0, 0, 0, None)
        )(keys, state, action, params)
        return state, (reward, terminated, truncated)
    observed, state = jax.vmap(env.reset, (0, None))(keys[0], params)
    state, told = jax.lax.scan(one, state, keys)
    return observed, state, told

keys = jax.random.split(jax.random.key(0), (50, 64))
alone = walk(*jax.device_put((params, keys), devices[0]))
mesh = Mesh(np.array(devices), ("batch",))
batch = NamedSharding(mesh, PartitionSpec(None, "batch"))
copied = NamedSharding(mesh, PartitionSpec())
shared = walk(jax.device_put(params, copied), jax.device_put(keys, batch))
for one, other in zip(jax.tree.leaves(alone), jax.tree.leaves(shared), strict=True):
    assert np.array_equal(one, other)
    # Each device has a quarter of the batch.
    axis = 1 if other.shape[0] == 50 else 0
    assert {part.data.shape[axis] for part in other.addressable_shards} == {16}
print("done")
"""

BITS_64 = """
import jax
import jax.numpy as jnp
import numpy as np
import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

level = brl.load("bat-cave")
env, params = brl_jax.make(level, observation=("position", "vector"))
mdp = level.compile()
is_drawn = np.asarray(params.next_state[: params.num_rows]) < 0
rewards = np.asarray(params.reward[: params.num_rows])
assert np.array_equal(rewards[~is_drawn], mdp.reward[..., 0].reshape(-1)[~is_drawn])
wanted = mdp.probability.reshape(params.num_rows, -1)[is_drawn, : params.most_outcomes]
assert np.abs(params.probability - wanted).max() < 1e-15

key = jax.random.key(1)
observed, state = env.reset(key, params)
observed, state, reward, *_ = env.step(key, state, 1, params)
assert reward.dtype == jnp.float64
assert {leaf.dtype.name for leaf in jax.tree.leaves(state)} == {"int32"}
types = {name: each.dtype.name for name, each in observed.items()}
assert types == {"position": "int32", "vector": "float32"}
alone, whole = (
    [leaf.dtype for leaf in jax.tree.leaves(each)] for each in (params.take(0), params)
)
assert alone == whole
print("done")
"""


def test_a_batch_is_divided_among_devices() -> None:
    flags = "--xla_force_host_platform_device_count=4"
    assert _printed("-c", SEVERAL_DEVICES, XLA_FLAGS=flags) == "done"


def test_tables_are_exact_with_64_bits() -> None:
    assert _printed("-c", BITS_64, JAX_ENABLE_X64="1") == "done"


def test_rewards_are_exact_with_64_bits() -> None:
    walks = Path(__file__).with_name("test_exactness.py")
    told = _printed("-m", "pytest", "-k", "single", str(walks), JAX_ENABLE_X64="1")
    assert "1 passed" in told


def _printed(*arguments: str, **environment: str) -> str:
    """Run Python in a process of its own, and return what it prints."""
    place = str(Path(babyrobot_levels.__file__).parents[1])
    ran = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": place, **environment},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout.strip()
