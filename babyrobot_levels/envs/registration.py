"""The ids under which Gymnasium knows the levels."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.catalogue import gallery_folder, yaml_files
from babyrobot_levels.files import ReadFault, read_source
from babyrobot_levels.syntax.document import YamlFault
from babyrobot_levels.syntax.reader import read

NAMESPACE = "babyrobot"
LEVEL_ID = f"{NAMESPACE}/Level-v0"


def register_all() -> None:
    """Register `babyrobot/Level-v0` and one id for each level of the gallery, once.

    The environments check the order of calls themselves (`ResetNeeded`), so that a first
    `render` needs no `reset`, and Gymnasium's wrapper for it is left out.
    """
    # Here, because importing Gymnasium is what calls this function when ours is imported first.
    from gymnasium.envs.registration import register, registry

    if LEVEL_ID in registry:
        return
    register(LEVEL_ID, entry_point="babyrobot_levels.envs.single:make_level", order_enforce=False)
    for path in yaml_files(gallery_folder()):
        register(
            f"{NAMESPACE}/{path.stem}-v0",
            entry_point="babyrobot_levels.envs.single:LevelEnv",
            order_enforce=False,
            max_episode_steps=_max_steps(path),
            kwargs={"level": path.stem},
        )


def _max_steps(path: Path) -> int | None:
    """Return a gallery level's `max_steps` without validating all of it."""
    try:
        data = read(read_source(path)).data
    except (ReadFault, YamlFault):
        return None
    steps = data.get("max_steps") if isinstance(data, dict) else None
    return steps if isinstance(steps, int) else None
