"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Folders of levels as one file, which is built, installed and removed.",
    commands={
        "pack": Command(
            "Share",
            "babyrobot_levels.extensions.packs.commands:pack",
            "Pack a folder of levels into one file.",
        ),
        "install": Command(
            "Share", "babyrobot_levels.extensions.packs.commands:install", "Install a pack."
        ),
        "uninstall": Command(
            "Share",
            "babyrobot_levels.extensions.packs.commands:uninstall",
            "Remove an installed pack.",
        ),
    },
)
