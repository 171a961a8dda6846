"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Extension

EXTENSION = Extension(
    summary="Dynamic programming, Monte Carlo and temporal differences, seen update by update."
)
