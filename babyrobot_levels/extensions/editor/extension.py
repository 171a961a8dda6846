"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Levels edited in the browser and in notebooks.",
    needs=("formats",),
    commands={
        "edit": Command(
            "Create",
            "babyrobot_levels.extensions.editor.commands:edit",
            "Edit a level in the browser.",
        )
    },
)
