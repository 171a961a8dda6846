"""Registers the environments' ids with Gymnasium, whichever package is imported first.

If Gymnasium is loaded, they are registered at once; else a finder waits at the front of the import
path for Gymnasium's `envs` package and registers them when that has been loaded.
"""

import sys
from collections.abc import Iterator, Sequence
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any

NAMESPACE = "babyrobot"
LEVEL_ID = f"{NAMESPACE}/Level-v0"
SUITE_ID = f"{NAMESPACE}/Suite-v0"


_AWAITED = "gymnasium.envs"


def install() -> None:
    """Register the environments now, or as soon as Gymnasium is imported. Can be called again."""
    if _AWAITED in sys.modules:
        register_all()
    elif not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


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
    from babyrobot_levels.library.search_path import GALLERY

    for name in _level_names():
        env_id = f"{NAMESPACE}/{name.replace('/', '.')}-v0"
        if env_id not in registry and is_id(env_id):
            # `register` looks through all ids each time, which takes long for thousands.
            level = name if "/" in name else f"{GALLERY}/{name}"
            registry[env_id] = level_spec(env_id, level=level)


def _level_names() -> Iterator[str]:
    """Yield the names of levels, as their files are called; the files are not read."""
    from babyrobot_levels.library.catalogue import files_in, is_suite_file
    from babyrobot_levels.library.search_path import gallery_place, pack_places

    for place in (gallery_place(), *pack_places()):
        for file in files_in(place):
            # A suite outside a folder `suites` is recognised when its environment is made.
            in_suites = "suites" in file.path.relative_to(place.folder).parts[:-1]
            if not (in_suites and is_suite_file(file.path)):
                yield file.name


class _Finder:
    """Hands out Gymnasium's own loader with our registration behind it, once."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != _AWAITED:
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            spec.loader = _Loader(spec.loader)  # type: ignore[assignment]
        return spec


class _Loader:
    """Gymnasium's loader; what it does not define itself is looked up there."""

    def __init__(self, loader: Any):
        self._loader = loader

    def __getattr__(self, name: str) -> object:
        return getattr(self._loader, name)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        module: ModuleType | None = self._loader.create_module(spec)
        return module

    def exec_module(self, module: ModuleType) -> None:
        self._loader.exec_module(module)
        if module.__spec__ is not None:
            module.__spec__.loader = self._loader
        module.__loader__ = self._loader
        register_all()
