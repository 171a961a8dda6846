"""What leads from words of other programs to ours leads to what there is."""

from __future__ import annotations

from babyrobot_levels.cli import meant
from babyrobot_levels.cli.commands import COMMANDS, _Registry
from babyrobot_levels.text.words import words_beside

WORDS = words_beside(meant.__file__)


def test_words_that_are_no_commands_lead_to_commands() -> None:
    words = [word for others in WORDS["commands"].values() for word in others.split()]
    assert not {*words} & {*COMMANDS}
    assert {each.split()[0] for each in WORDS["commands"]} <= {
        *COMMANDS,
        "--help",
        "--version",
        "--install-completion",
    }


def test_options_of_others_lead_to_options_of_a_command_that_lacks_them() -> None:
    registry = _Registry()
    known = [{name for each in registry[one].params for name in each.opts} for one in COMMANDS]
    led = {
        name
        for ours, others in WORDS["options"].items()
        for name in others.split()
        if any(
            name not in has and meant.option(name, has, ()) == f". Did you mean `{ours}`?"
            for has in known
        )
    }
    assert led == {name for others in WORDS["options"].values() for name in others.split()}


def test_words_of_difficulty_are_no_tags() -> None:
    assert meant.tag("easy", ["areas"]) == "; did you mean `--difficulty A..B`?"
    assert meant.tag("area", ["areas"]) == "; did you mean `areas`?"
