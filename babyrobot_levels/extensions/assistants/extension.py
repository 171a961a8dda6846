"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="A page for assistants that write levels, and a server of tools for them.",
    needs=("scoring",),
    commands={
        "mcp": Command(
            "Editors and assistants",
            "babyrobot_levels.extensions.assistants.commands:mcp",
            "Serve tools for assistants that write levels.",
        ),
        "skill": Command(
            "Editors and assistants",
            "babyrobot_levels.extensions.assistants.commands:skill",
            "Print a page for assistants that write levels.",
        ),
    },
)
