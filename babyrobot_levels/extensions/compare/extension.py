"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Whether two levels are the same MDP, and what differs between them.",
    commands={
        "compare": Command(
            "Analyse",
            "babyrobot_levels.extensions.compare.commands.compare:compare",
            "Test whether two levels are the same MDP.",
            limited=True,
        ),
        "diff": Command(
            "Analyse",
            "babyrobot_levels.extensions.compare.commands.diff:diff",
            "Show what differs between two levels.",
            limited=True,
        ),
    },
)
