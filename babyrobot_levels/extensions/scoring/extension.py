"""What this extension adds to the package."""

from babyrobot_levels.registry.manifest import Command, Extension

EXTENSION = Extension(
    summary="Scores of agents against the exact optimum, and grades of what is handed in.",
    needs=("learning", "packs"),
    commands={
        "replay": Command(
            "Look and play",
            "babyrobot_levels.extensions.scoring.commands.replay:replay",
            "Verify and show recorded episodes.",
            limited=True,
        ),
        "grade": Command(
            "Analyse",
            "babyrobot_levels.extensions.scoring.commands.grade:grade",
            "Grade all that a class hands in.",
            limited=True,
        ),
        "score": Command(
            "Analyse",
            "babyrobot_levels.extensions.scoring.commands.score:score",
            "Score agents and recorded episodes.",
            limited=True,
        ),
    },
)
