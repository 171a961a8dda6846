"""Share codes: the way there and back, and what becomes of codes that are not whole."""

from __future__ import annotations

import contextlib
import hashlib
import re
import zlib
from pathlib import Path

import gymnasium
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.codes import code_of, packed, sealed
from support.each import for_each
from support.things import thing_worlds
from support.work import traced_memory
from support.worlds import LEGEND, World, decorated_worlds, drawings, level_of

import babyrobot_levels as brl
from babyrobot_levels.language.drawing import Drawing, compose
from babyrobot_levels.language.share_code import DICTIONARY_1, MAX_CHARACTERS, is_code
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level, load_code, load_file
from babyrobot_levels.text.errors import LevelError, LevelNotFoundError
from babyrobot_levels.text.source import MAX_BYTES

NAMES = ["areas", "blocked-shapes", "final-maze", "glasshouse", "night-watch", "teleport-pads"]
"""Levels that differ in kind; what is kept for ever holds the codes of all levels."""

MAZE = (
    "brl1.188.vaNOG8OakqDxjpyaoEKoKQomAWvKwVoRVtCeCqh5CerBJAPrAGCbA1Sx5EFau-D2IDB2FUyM9GLy_POg7UV"
    "ItwPaFASlGR1wmwjYgAQ2BMvBnThQuwrU2Aa1WzNLIM3CSlBfKbUS2HwB13Z6yMmZsnYPUmZAaciBgwORHyx0TOFJPto"
    "UHHuoadgEmGsB"
)
"""A code that is in the world: version 1 reads it for ever. Packers may write another one."""


def assert_same(other: Level, level: Level) -> None:
    assert other.to_dict(whole=True) == level.to_dict(whole=True)
    assert other.resolved_theme == level.resolved_theme
    assert other.name == level.name


# -- there and back ------------------------------------------------------------------------


def drawn(drawing: Drawing) -> World:
    return {"version": 1, "map": compose(drawing), "legend": LEGEND}


@given(decorated_worlds() | thing_worlds() | drawings().map(drawn))
def test_a_code_holds_the_whole_level(world: World) -> None:
    level = level_of(world)
    code = level.share_code()
    other = load(code)
    assert_same(other, level)
    assert other.digest == level.digest
    assert re.fullmatch(r"brl1\.[0-9]+\.[A-Za-z0-9_-]+", code)
    assert other.share_code() == code


@given(st.floats(-1e300, 1e300), st.integers(-(10**30), 10**30))
def test_a_code_holds_any_number(reward: float, seed: int) -> None:
    level = level_of({"version": 1, "rewards": {"step": reward}, "maze": {"seed": seed}})
    assert_same(load(level.share_code()), level)


@given(st.text())
def test_a_code_holds_any_text(text: str) -> None:
    level = level_of({"version": 1, "title": text})
    assert load(level.share_code()).title == text


@for_each("name", NAMES)
def test_a_code_holds_each_level_of_the_gallery(name: str) -> None:
    # What a level states of itself is no part of its code.
    level = load(name).replace(expect=None)
    other = load(level.share_code())
    assert_same(other, level)
    assert load(name).share_code() == level.share_code()
    if level.has_random_maze:
        level, other = level.with_maze_seed(3), other.with_maze_seed(3)
    assert other.digest == level.digest
    assert other.to_svg() == level.to_svg()


def test_the_final_maze_fits_into_a_chat_line() -> None:
    assert len(load("final-maze").share_code()) < 300


def test_a_code_carries_a_theme_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "themes").mkdir()
    (tmp_path / "themes" / "mine.yaml").write_text("colors: {base: red}\n", "utf-8")
    (tmp_path / "level.yaml").write_text("version: 1\ntheme: mine\n", "utf-8")
    level = load_file(tmp_path / "level.yaml")
    other = load(level.share_code())
    assert other.resolved_theme.colors.base == "red"
    assert (other.name, other.to_svg()) == ("level", level.to_svg())


def test_a_level_from_a_code_is_saved_as_yaml(tmp_path: Path) -> None:
    load(MAZE).save(tmp_path / "maze.yaml")
    text = (tmp_path / "maze.yaml").read_text("utf-8")
    assert text == load(MAZE).to_yaml()
    assert text.startswith("version: 1\nname: maze\ntitle: The maze\n")


def test_old_codes_are_read_for_ever() -> None:
    level = load("maze")
    assert load(MAZE).digest == level.digest
    told = hashlib.sha256(DICTIONARY_1).hexdigest()
    assert told == "16171620c3b7495ccc452a50dff88171372da5e68a936df12a7b5339d8e9bf81"


def test_a_level_that_no_file_could_hold_has_no_code() -> None:
    level = Level(version=1, description="x" * MAX_BYTES)
    with pytest.raises(LevelError, match="too large for a share code"):
        level.share_code()


# -- codes as people paste them --------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        f"  {MAZE}\n",
        f"{MAZE[:40]}\n{MAZE[40:90]}\r\n\t{MAZE[90:]}",
        f"https://example.org/play.html?theme=dark#{MAZE}",
        f"play.html#{MAZE} ",
        MAZE.replace("brl1", "Brl1"),
    ],
    ids=["blanks", "lines", "link", "relative link", "capital"],
)
def test_codes_are_read_as_they_are_pasted(text: str) -> None:
    assert is_code(text)
    assert load(text).digest == load("maze").digest


@pytest.mark.parametrize("text", ["brl1", "brl.x", "brl1.yaml", "a/brl1.yml", "xbrl1.a"])
def test_other_texts_are_no_codes(text: str) -> None:
    assert not is_code(text)
    with pytest.raises(LevelNotFoundError):
        load(text)


def test_every_place_that_takes_a_level_takes_a_code() -> None:
    digest = load("maze").digest
    env = gymnasium.make("babyrobot/Level-v0", level=MAZE)
    assert env.unwrapped.level_digest == digest  # type: ignore[attr-defined]
    assert gymnasium.make(env.spec).unwrapped.level.digest == digest  # type: ignore[arg-type, attr-defined]
    envs = gymnasium.make_vec("babyrobot/Level-v0", num_envs=2, level=MAZE)
    assert envs.unwrapped.levels[0].digest == digest  # type: ignore[attr-defined]
    assert brl.solve(MAZE).expected_return == brl.solve("maze").expected_return
    assert brl.evaluate(MAZE, "random").expected_return == pytest.approx(-1754, abs=1)
    assert brl.metrics(MAZE).path_length == brl.metrics("maze").path_length
    assert brl.compare(MAZE, "maze").equal


# -- damaged codes ---------------------------------------------------------------------------


@given(st.integers(0, len(MAZE) - 1), st.characters(exclude_categories=["Z", "C"]))
def test_no_changed_character_goes_unnoticed(place: int, character: str) -> None:
    code = MAZE[:place] + character + MAZE[place + 1 :]
    if code == MAZE or (place < 3 and code.lower() == MAZE.lower()):
        return
    with pytest.raises((LevelError, LevelNotFoundError)):
        load(code)


@for_each("length", range(5, len(MAZE)))
def test_a_code_that_is_cut_off_says_so(length: int) -> None:
    with pytest.raises(LevelError, match=r"^the share code is cut off: "):
        load(MAZE[:length])


@pytest.mark.parametrize(
    ("code", "message"),
    [
        (MAZE[:-5], "the share code is cut off: the last 5 of its 197 characters are missing"),
        ("brl1.", "the share code is cut off: hardly anything of it is there"),
        ("brl1.12", "the share code is cut off: hardly anything of it is there"),
        (MAZE + "abc", "the share code is damaged: there are 3 characters too many"),
        (MAZE.lower(), "damaged: its checksum is wrong (capital and small letters differ)"),
        (MAZE[:50] + "ä" + MAZE[51:], "damaged: 'ä', its character 51, cannot stand in one"),
        ("brl1.x", "the share code is damaged: it has no length"),
        ("brl1.1.A", "the share code is damaged: its length is wrong"),
        ("brl1.0.", "the share code is damaged: its checksum is wrong"),
        (
            MAZE.replace("brl1", "brl2"),
            "is of version 2, and this babyrobot-levels reads version 1",
        ),
        ("brl1." + "A" * MAX_CHARACTERS, "the share code is longer than that of any level"),
        (sealed(b"\xff\xff"), "the share code is damaged: its data cannot be unpacked"),
        (sealed(packed(b"{}") + b"more"), "damaged: its data do not end where they should"),
        (sealed(packed(b"{}")[:-1]), "damaged: its data do not end where they should"),
        (sealed(b""), "damaged: its data do not end where they should"),
    ],
)
def test_damages_have_words_of_their_own(code: str, message: str) -> None:
    with pytest.raises(LevelError) as caught:
        load(code)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_base64_can_be_written_in_one_way_only() -> None:
    # The last character has bits that belong to no byte.
    codes = (code_of(b"version: 1\ntitle: t%d\n" % number) for number in range(999))
    code = next(code for code in codes if len(code.split(".")[2]) % 4 == 2)
    alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"
    readable = []
    for character in alphabet:
        try:
            load(code[:-1] + character)
        except LevelError:
            continue
        readable.append(character)
    assert readable == [code[-1]]


# -- hostile codes ---------------------------------------------------------------------------


@pytest.mark.slow
def test_a_bomb_is_refused_before_it_is_unpacked() -> None:
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = b" " * (1 << 20)
    code = sealed(b"".join(packer.compress(block) for _ in range(64)) + packer.flush())
    assert len(code) < MAX_CHARACTERS
    with traced_memory() as work, pytest.raises(LevelError, match="larger than 1 MiB"):
        load(code)
    assert work.memory < 16 << 20


@pytest.mark.parametrize(
    ("data", "rule"),
    [
        (b'{"version":1,"size":[0,4]}', "BR205"),
        (b'{"version":1,"colour":"red"}', "BR201"),
        (b'{"version":1,"version":1}', "BR105"),
        (b'{"version":2}', "BR204"),
        (b'{"version":1,"theme":"mine"}', "BR401"),
        (b'{"version":1,"discount":NaN}', "BR203"),
        (b"\xff\xfe", "BR102"),
        (b"[" * 5000, "BR109"),
        (b"{" * 5000, "BR109"),
        (b"", "BR110"),
        (b"a: &a [*a]", "BR108"),
        (b'{"version":1,"title":"\\ud800"}', "BR104"),
    ],
)
def test_what_a_code_holds_is_checked_as_a_file_is(data: bytes, rule: str) -> None:
    with pytest.raises(LevelError) as caught:
        load(code_of(data))
    assert [found.code for found in caught.value.diagnostics] == [rule]
    assert "\nshare code:" in str(caught.value)


@given(st.binary(max_size=300))
def test_whatever_a_code_holds_nothing_but_a_level_error_comes_of_it(data: bytes) -> None:
    for code in (code_of(data), sealed(data)):
        with contextlib.suppress(LevelError):
            load_code(code)
