"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Several robots: an agent for each, and what each of them loses; plans for many.",
    needs=("formats",),
    commands={
        "check-plan": Command(
            "Analyse",
            "babyrobot_levels.extensions.robots.commands:check_plan",
            "Check a plan for many agents, and what it costs.",
            limited=True,
        )
    },
)
