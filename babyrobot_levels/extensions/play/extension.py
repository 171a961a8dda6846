"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Levels played in the terminal.",
    commands={
        "play": Command(
            "Look and play",
            "babyrobot_levels.extensions.play.commands.play:play",
            "Play a level in the terminal.",
            limited=True,
        )
    },
)
