"""How new levels are among known ones."""

from __future__ import annotations

import numpy as np
import pytest

import babyrobot_levels as brl

NAMES = ["maze", "final-maze", "first-key", "four-rooms", "frozen-lake"]
FEATURES = ("cells", "loops", "path_length")


def measured(name: str) -> list[float]:
    found = brl.metrics(name)
    return [getattr(found, feature) for feature in FEATURES]


def test_it_is_the_mean_distance_to_the_nearest_in_standard_deviations() -> None:
    archive = brl.NoveltyArchive(NAMES[1:], features=FEATURES, nearest=2)
    known, own = np.array([measured(name) for name in NAMES[1:]]), np.array(measured(NAMES[0]))
    apart = np.sqrt((((known - own) / known.std(axis=0)) ** 2).sum(axis=1))
    assert archive.novelty(NAMES[:1]) == pytest.approx([np.sort(apart)[:2].mean()])


def test_known_levels_are_not_new_whatever_their_name() -> None:
    archive = brl.NoveltyArchive(NAMES[:2])
    other = brl.load(NAMES[0]).replace(name="another")
    assert other in archive
    assert len(archive) == 2
    assert brl.load(NAMES[2]) not in archive
    assert archive.novelty(other).tolist() == [0.0]
    found = archive.novelty(NAMES)
    assert (found[:2] == 0).all()
    assert (found[2:] > 0).all()
    archive.add([*NAMES, other])
    assert len(archive) == len(NAMES)
    assert not archive.novelty(NAMES).any()


def test_where_known_levels_agree_or_have_no_value() -> None:
    nowhere = {"version": 1, "size": [2, 2], "exit": "none"}
    archive = brl.NoveltyArchive([nowhere], features=("path_length", "items", "cells"))
    first, found = brl.metrics(nowhere), brl.metrics("first-key")
    assert first.path_length is None
    expected = np.hypot(found.items - first.items, found.cells - first.cells)
    assert archive.novelty("first-key") == pytest.approx([expected])


def test_a_sampler_takes_it() -> None:
    suite = brl.load_suite("small-mazes").split("train")[:8]
    archive = brl.NoveltyArchive(suite[:4])
    sampler = brl.PrioritizedSampler(len(suite), by="score", staleness=0.0)
    sampler.update(range(len(suite)), archive.novelty(suite))
    assert (sampler.probabilities()[:4] == 0).all()


def test_what_it_cannot_be_asked() -> None:
    with pytest.raises(ValueError, match=r"^a feature must be one of 'cells', .* not 'exits'"):
        brl.NoveltyArchive(features=("cells", "exits"))
    with pytest.raises(ValueError, match=r"^nearest must be a whole number, at least 1, not 0$"):
        brl.NoveltyArchive(nearest=0)
    with pytest.raises(ValueError, match=r"^no level is known yet: add some$"):
        brl.NoveltyArchive().novelty("maze")
