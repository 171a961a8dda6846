"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Many levels at once: generated, and evolved by small changes.",
    commands={
        "generate": Command(
            "Create",
            "babyrobot_levels.extensions.generate.commands:generate",
            "Generate many levels.",
            limited=True,
        )
    },
)
