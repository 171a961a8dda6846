"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Galleries, data sets, courses and exercise sheets.",
    needs=("editor", "learning", "packs"),
    commands={
        "sheet": Command(
            "Share",
            "babyrobot_levels.extensions.publish.commands:sheet",
            "Print levels on an exercise sheet, or its key.",
            limited=True,
        ),
        "gallery": Command(
            "Share",
            "babyrobot_levels.extensions.publish.commands:gallery",
            "Write web pages of many levels.",
            limited=True,
        ),
        "dataset": Command(
            "Share",
            "babyrobot_levels.extensions.publish.commands:dataset",
            "Write levels as a data set of rows.",
            limited=True,
        ),
        "course": Command(
            "Share",
            "babyrobot_levels.extensions.publish.commands:course",
            "Begin a course, or build all that it hands out.",
            limited=True,
        ),
    },
)
