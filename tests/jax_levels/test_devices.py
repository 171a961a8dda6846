"""A batch of environments on several devices, which take a process of their own to have."""

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


def test_a_batch_is_divided_among_devices() -> None:
    flags = "--xla_force_host_platform_device_count=4"
    place = str(Path(babyrobot_levels.__file__).parents[1])
    ran = subprocess.run(
        [sys.executable, "-c", SEVERAL_DEVICES],
        env={**os.environ, "JAX_PLATFORMS": "cpu", "PYTHONPATH": place, "XLA_FLAGS": flags},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == "done\n"
