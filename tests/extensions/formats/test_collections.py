"""Several worlds in one text: collections of Sokoban."""

from __future__ import annotations

import pytest
from support.conversions import level_of_world

from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

BOXOBAN = """; 0
#####
#@$.#
#####

; 1
######
#@ $.#
######
"""
SOK = """:: a collection
Author: Somebody

#####
#@$.#
#####
Title: One
Date: today

#####
#.$@#
#####
Title: Two
Author: Other
"""
XSB = """A set

Level 1

 #####
 #@$.#
 #####

Level 2

 #####
 #.$@#
 #####
"""
SLC = """<?xml version="1.0" encoding="ISO-8859-1"?>
<SokobanLevels xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
  <Title>A set</Title>
  <LevelCollection Copyright="Somebody">
    <Level Id="One" Width="5" Height="3"><L>#####</L><L>#@$.#</L><L>#####</L></Level>
    <Level Id="Two" Copyright="Other"><L>#####</L><L>#.$@#</L><L>#####</L></Level>
  </LevelCollection>
</SokobanLevels>
"""


def worlds(text: str, name: str = "set.txt") -> list[Level]:
    source = SourceFile(name, text)
    assert guess(source) == ["sokoban"]
    entry = FORMATS["sokoban"]
    return [
        level_of_world(entry.read(source, number=number + 1))
        for number in range(len(entry.parts(source)))
    ]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (BOXOBAN, [(None, None), (None, None)]),
        (SOK, [("One", "Somebody"), ("Two", "Other")]),
        (XSB, [("Level 1", None), ("Level 2", None)]),
        (SLC, [("One", "Somebody"), ("Two", "Other")]),
    ],
    ids=["boxoban", "sok", "xsb", "slc"],
)
def test_each_map_has_what_is_told_of_it(text: str, told: list[tuple[str, str]]) -> None:
    levels = worlds(text)
    assert [(level.title, level.author) for level in levels] == told
    assert [level.height for level in levels] == [1, 1]
    assert (levels[0].starts, levels[0].boxes[0].at) == (((0, 0),), (1, 0))
    assert [target.at for target in levels[0].targets] == [(2, 0)]


def test_lines_that_say_more_are_the_description() -> None:
    assert [level.description for level in worlds(SOK)] == ["Date: today", None]
    assert [level.description for level in worlds(SLC)] == ["Collection: A set"] * 2


def test_runs_are_written_out() -> None:
    assert worlds("5#|#@$.#|5#\n")[0].digest == worlds(BOXOBAN)[0].digest
    assert worlds("2#3#\n#@$-1.#\n6#\n")[0].size == (4, 1)


@pytest.mark.parametrize("runs", ["#@9999999999$.#", "#@99999$.#|99999999#", "9999|" * 999 + "#@#"])
def test_runs_without_end_are_refused_at_once(runs: str) -> None:
    with pytest.raises(ConversionError, match="more cells than a level has"):
        FORMATS["sokoban"].read(SourceFile("set.txt", f"4#\n{runs}\n4#\n"))


def test_a_fault_is_shown_where_it_is_in_the_whole_text() -> None:
    source = SourceFile("set.txt", BOXOBAN.replace("#@ $.#", "#@?$.#"))
    with pytest.raises(ConversionError, match=r"set\.txt:8:3: error: unknown character `\?`"):
        FORMATS["sokoban"].read(source, number=2)


@pytest.mark.parametrize("number", [None, 3])
def test_one_of_several_is_chosen_by_its_number(number: int | None) -> None:
    with pytest.raises(ConversionError, match="the text has 2 worlds") as caught:
        FORMATS["sokoban"].read(SourceFile("set.txt", BOXOBAN), number=number)
    assert "--number N" in str(caught.value)


def test_a_collection_has_an_end() -> None:
    source = SourceFile("set.txt", "#@\n\n" * 10_001)
    with pytest.raises(ConversionError, match="10,001 worlds; at most 10,000"):
        FORMATS["sokoban"].parts(source)


BOMB = '<!DOCTYPE a [<!ENTITY b "bbb">]>\n<SokobanLevels><Title>&b;</Title></SokobanLevels>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, r"1:\d+: error: XML that declares entities is not read"),
        ("<SokobanLevels>" + "<a>" * 99, r"nested deeper than 32 levels"),
        ("<SokobanLevels><Level>", r"1:23: error: invalid XML \(no element found\)"),
        ("<SokobanLevels/>", "the text has 0 worlds"),
    ],
)
def test_xml_that_would_harm_is_refused(text: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        FORMATS["sokoban"].read(SourceFile("set.slc", text))
