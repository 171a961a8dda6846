"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Worlds of other programs, read and written.",
    commands={
        "import": Command(
            "Create",
            "babyrobot_levels.extensions.formats.commands:import_level",
            "Convert a file of another program.",
        ),
        "export": Command(
            "Share",
            "babyrobot_levels.extensions.formats.commands:export_level",
            "Convert a level for another program.",
            limited=True,
        ),
    },
)
