"""The ids under which Gymnasium knows the levels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from babyrobot_levels.catalogue import gallery_folder, yaml_files
from babyrobot_levels.files import ReadFault, read_source
from babyrobot_levels.syntax.document import YamlFault
from babyrobot_levels.syntax.reader import read

NAMESPACE = "babyrobot"
LEVEL_ID = f"{NAMESPACE}/Level-v0"
SUITE_ID = f"{NAMESPACE}/Suite-v0"
SINGLE = "babyrobot_levels.envs.single"
VECTOR = "babyrobot_levels.envs.vector.env:LevelVectorEnv"


def register_all() -> None:
    """Register Level-v0, Suite-v0 and one id for each level of the gallery, once.

    The environments check the order of calls themselves (`ResetNeeded`), so that a first
    `render` needs no `reset`, and Gymnasium's wrapper for it is left out.
    """
    # Here, because importing Gymnasium is what calls this function when ours is imported first.
    from gymnasium.envs.registration import register, registry

    if LEVEL_ID in registry:
        return
    register(
        LEVEL_ID,
        entry_point=f"{SINGLE}:make_level",
        vector_entry_point=VECTOR,
        order_enforce=False,
    )
    register(SUITE_ID, entry_point="babyrobot_levels.envs.suite:make_suite", order_enforce=False)
    for path in yaml_files(gallery_folder()):
        data = _data(path)
        if "kind" in data:
            # A suite is played as `Suite-v0`.
            continue
        steps, maze = data.get("max_steps"), data.get("maze")
        # Levels that grow another maze each time are played one by one.
        grows = isinstance(maze, dict) and maze.get("seed") == "random"
        register(
            f"{NAMESPACE}/{path.stem}-v0",
            entry_point=f"{SINGLE}:LevelEnv",
            vector_entry_point=None if grows else VECTOR,
            order_enforce=False,
            max_episode_steps=steps if isinstance(steps, int) else None,
            kwargs={"level": path.stem},
        )


def _data(path: Path) -> dict[str, Any]:
    """Return what a gallery level's file says, without validating it."""
    try:
        data = read(read_source(path)).data
    except (ReadFault, YamlFault):
        return {}
    return data if isinstance(data, dict) else {}
