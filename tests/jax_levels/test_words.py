"""Words of 32 bits stand for draws, exactly."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from babyrobot_levels.jax.words import below, chosen, thresholds

WORDS = np.unique(
    np.concatenate(
        [
            np.random.default_rng(0).integers(0, 2**32, 2000, np.uint32),
            np.array([0, 1, 2**16, 2**31 - 1, 2**31, 2**32 - 2, 2**32 - 1], np.uint32),
        ]
    )
)


def test_a_word_selects_the_number_that_its_draw_selects() -> None:
    counts = np.array([1, 2, 3, 7, 1000, 2**16, 2**16 + 1, 2**30, 2**31 - 1])
    found = jax.vmap(jax.vmap(below, (None, 0)), (0, None))(WORDS, jnp.asarray(counts))
    wanted = [[word * count >> 32 for count in counts.tolist()] for word in WORDS.tolist()]
    assert np.asarray(found).tolist() == wanted


def test_a_word_draws_the_outcome_that_its_draw_draws() -> None:
    rows = np.cumsum([[0.1, 0.2, 0.7], [1 / 3, 1 / 3, 1 / 3], [2.0**-40, 0.5, 0.5]], axis=1)
    # The draws at the thresholds themselves, and beside them.
    edges = np.ceil(rows[:, :-1].reshape(-1) * 2.0**32).astype(np.int64)
    words = np.concatenate([WORDS, *((edges + step).clip(0, 2**32 - 1) for step in (-1, 0, 1))])
    for row in rows:
        # An action with one outcome fewer than another has a threshold of 1.
        for cumulated in (row[:-1], np.append(row[:-1], 1.0)):
            limits = jnp.asarray(thresholds(cumulated))
            found = chosen(jnp.asarray(words, jnp.uint32)[:, None], limits)
            wanted = (words[:, None] / 2.0**32 >= cumulated).sum(axis=1)
            assert np.array_equal(found, wanted)
