"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Extension

EXTENSION = Extension(summary="Levels as games of arcengine, the engine of ARC-AGI-3.")
