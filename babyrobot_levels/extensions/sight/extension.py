"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Extension

EXTENSION = Extension(summary="The optimum of partial observation.", needs=("formats",))
