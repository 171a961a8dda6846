"""`show`: the facts about a level, as data, as lines and as a table."""

from __future__ import annotations

import json

import babyrobot_levels as brl
from babyrobot_levels.language.metric_names import NEEDS, SOLVED


def test_the_facts_are_plain_data() -> None:
    facts = brl.show("final-maze")
    level = brl.load("final-maze")
    assert json.loads(json.dumps(facts)) == facts
    assert (facts["name"], facts["digest"]) == ("final-maze", level.digest)
    assert facts["drawing"] == level.draw()
    assert facts["metrics"]["path_length"] == brl.metrics(level).path_length
    assert level.show() == facts


def test_they_show_themselves() -> None:
    facts = brl.show("final-maze")
    lines = repr(facts).splitlines()
    assert lines[0].split() == ["name:", "final-maze"]
    assert lines[-1] == brl.load("final-maze").draw().splitlines()[-1]
    table = facts._repr_mimebundle_()["text/html"]
    assert '<th style="text-align: left">size</th>' in table
    assert "<img " in table


def test_a_random_maze_has_no_tables() -> None:
    facts = brl.show("random-maze")
    assert facts["random_maze"] is True
    assert facts["digest"] is facts["metrics"] is facts["drawing"] is None
    assert "digest" not in repr(facts)


def test_what_is_not_known_says_why() -> None:
    def facts(**fields: object) -> dict[str, str]:
        return brl.show({"version": 1, "size": [4, 1], **fields}).lines()

    assert facts(exit="none")["difficulty"] == "none: there is no exit"
    shut = facts(walls=[{"at": [0, 0], "side": "E"}])
    assert (
        shut["path_length"]
        == shut["difficulty"]
        == "none: from a start, no path to an exit is known"
    )
    lure = facts(start=[1, 0], areas=[{"at": [0, 0], "reward": 50, "ends": True}])
    assert lure["path_length"] == "2"
    assert lure["difficulty"] == "none: the best policy does not go to an exit"
    assert lure["ending"] == (
        "the optimal policy reaches an exit in 0 % of the episodes; 100 % end at [0, 0]"
    )
    assert facts(exit="none")["success"] == "none: there is no exit"
    large = facts(size=[80, 80])
    assert {large[name] for name in SOLVED} == {"not computed above 5,000 states"}
    assert not large.keys() & {*NEEDS}
