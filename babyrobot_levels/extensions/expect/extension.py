"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Facts about levels, written into their files.",
    commands={
        "expect": Command(
            "Check",
            "babyrobot_levels.extensions.expect.commands:expect",
            "State facts about levels in their files.",
            limited=True,
        )
    },
)
