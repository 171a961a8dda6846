"""Links: a share code that every command reads, and behind it what a page plays."""

from __future__ import annotations

import hashlib
import json
import re
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.codes import play_data, play_stream
from support.worlds import World, decorated_worlds, level_of

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.language.share_code import PLAY_DICTIONARY_1
from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import MAX_LINK, link_fragment, page_data
from babyrobot_levels.render.page_format import TooLargeError
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError

NAMES = [info.name for info in levels()]
SMALL = 25
"""The most cells of a level that is called small."""


def link_of(level: Level) -> str:
    """Return a link as `babyrobot share --link` makes it."""
    game = level.with_maze_seed(0) if level.has_random_maze else level
    return "https://example.org/#" + link_fragment(level, game, guide_of(game))


@given(decorated_worlds())
def test_a_link_is_read_as_its_level(world: World) -> None:
    level = level_of(world)
    link = f"play.html#{link_fragment(level, level)}"
    other = load(link)
    assert other.digest == level.digest
    assert other.to_dict(whole=True) == level.to_dict(whole=True)
    assert play_data(link) == json.loads(json.dumps(page_data(level)))


@pytest.mark.parametrize("name", NAMES)
def test_links_are_short(name: str) -> None:
    level = load(name)
    link = link_of(level)
    width, height = level.size
    # Values and actions differ between the configurations of things.
    longest = 16_000 if level.has_things else 5400
    assert len(link) < (3400 if width * height <= SMALL and not level.has_things else longest)
    assert re.fullmatch(r"[A-Za-z0-9._~-]+", link.partition("#")[2])
    assert load(link).to_dict(whole=True) == level.to_dict(whole=True)


@given(st.integers(0, 3000))
def test_however_much_of_the_play_part_is_missing_the_level_is_read(length: int) -> None:
    code, mark, part = LINK.partition("~")
    assert load(code + mark + part[:length]).digest == DIGEST
    assert load(f"{code}%7E{part[:length]}").digest == DIGEST


@given(st.data())
def test_no_changed_character_of_the_code_goes_unnoticed(data: st.DataObject) -> None:
    begin, end = LINK.index("brl1."), LINK.index("~")
    place = data.draw(st.integers(begin + 5, end - 1))
    character = data.draw(st.sampled_from("AZaz09-_.~"))
    if LINK[place] != character:
        with pytest.raises((LevelError, LevelNotFoundError)):
            load(LINK[:place] + character + LINK[place + 1 :])


LINK = link_of(load("two-doors"))
DIGEST = load("two-doors").digest


def test_a_link_says_what_a_page_says() -> None:
    level = load("final-maze")
    guide = guide_of(level)
    assert play_data(link_of(level)) == json.loads(json.dumps(page_data(level, guide=guide)))


def test_a_reader_without_dictionaries_can_use_a_stored_block() -> None:
    size = len(PLAY_DICTIONARY_1)
    head = b"\0" + size.to_bytes(2, "little") + (size ^ 0xFFFF).to_bytes(2, "little")
    data = zlib.decompress(head + PLAY_DICTIONARY_1 + play_stream(LINK), -15)[size:]
    assert json.loads(data) == play_data(LINK)


def test_the_dictionary_of_version_1_stays_as_it_is() -> None:
    told = hashlib.sha256(PLAY_DICTIONARY_1).hexdigest()
    assert told == "71b860eaddc5c0dfdfd43b4e108bf7dba4bcfc188d6394f03fe27593f06517ec"


def test_a_level_that_is_too_large_for_a_link_says_so() -> None:
    large = Level.from_fields({"version": 1, "size": [128, 128], "maze": {"seed": 1}})
    with pytest.raises(TooLargeError, match=rf"too large for a link: .* limit is {MAX_LINK:,}"):
        link_fragment(large, large)


def test_a_link_does_not_hold_more_than_a_page_unpacks(monkeypatch: pytest.MonkeyPatch) -> None:
    level = Level.from_fields({"version": 1, "description": "x" * 10_000})
    data = json.dumps(page_data(level), ensure_ascii=False, separators=(",", ":"))
    size = len(data.encode())
    monkeypatch.setattr("babyrobot_levels.render.page.MAX_UNPACKED", size)
    assert len(link_fragment(level, level)) < MAX_LINK
    monkeypatch.setattr("babyrobot_levels.render.page.MAX_UNPACKED", size - 1)
    with pytest.raises(TooLargeError, match=f"its data has .* the limit is {size - 1:,}"):
        link_fragment(level, level)


def test_a_level_with_more_cells_than_a_page_has_room_for_says_so() -> None:
    large = Level.from_fields({"version": 1, "size": [129, 128]})
    with pytest.raises(TooLargeError, match="too large for a page"):
        link_fragment(large, large)
