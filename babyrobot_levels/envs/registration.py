"""Registers the environments' ids with Gymnasium."""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.library.catalogue import files_in, is_suite_file
from babyrobot_levels.library.search_path import GALLERY, gallery_place, pack_places

NAMESPACE = "babyrobot"
LEVEL_ID = f"{NAMESPACE}/Level-v0"
SUITE_ID = f"{NAMESPACE}/Suite-v0"


def register_all() -> None:
    """Register Level-v0, Suite-v0 and an id for each level of the gallery and of packs, once."""
    # Not at the top: if this package is imported before Gymnasium, importing Gymnasium calls this.
    from gymnasium.envs.registration import registry

    from babyrobot_levels.envs.specs import level_spec, suite_spec

    if LEVEL_ID not in registry:
        registry[LEVEL_ID] = level_spec(LEVEL_ID)
        registry[SUITE_ID] = suite_spec(SUITE_ID)
        register_levels()


def register_levels() -> None:
    """Register an id for each level of the gallery and of packs that has none yet.

    `babyrobot/NAME-v0` is a level of the gallery, `babyrobot/PACK.NAME-v0` one of a pack. Names
    that cannot be part of an id are skipped.
    """
    from gymnasium.envs.registration import registry

    from babyrobot_levels.envs.specs import is_id, level_spec

    for name in _level_names():
        env_id = f"{NAMESPACE}/{name.replace('/', '.')}-v0"
        if env_id not in registry and is_id(env_id):
            # `register` looks through all ids each time, which takes long for thousands.
            level = name if "/" in name else f"{GALLERY}/{name}"
            registry[env_id] = level_spec(env_id, level=level)


def _level_names() -> Iterator[str]:
    """Yield the names of levels, as their files are called; the files are not read."""
    for place in (gallery_place(), *pack_places()):
        for file in files_in(place):
            # A suite outside a folder `suites` is recognised when its environment is made.
            in_suites = "suites" in file.path.relative_to(place.folder).parts[:-1]
            if not (in_suites and is_suite_file(file.path)):
                yield file.name
