"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Extension

EXTENSION = Extension(summary="Several robots: an agent for each, and what each of them loses.")
