"""A level drawn from an empty grid: by mouse alone, by keyboard alone, by touch alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.combinations import swept
from support.editors import OpenEditor
from support.folders import babyrobot
from support.hands import SAYS, Finger, Hand, Keys, Mouse

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import load_file

pytestmark = pytest.mark.slow

EMPTY = "version: 1\n"

ROOM = """\
version: 1
size: [4, 2]
exit: [3, 0]
walls:
  - {at: [0, 1], side: E}
items:
  - {name: key, at: [0, 1]}
"""


@pytest.mark.parametrize("kind", swept([Finger], [Keys, Mouse]))
def test_the_final_maze_is_drawn_from_an_empty_grid(
    kind: type[Hand], editor_page: OpenEditor, tmp_path: Path
) -> None:
    wanted = load("final-maze").resolve()
    hand = kind(editor_page(EMPTY, **kind.context))
    hand.resize(*wanted.size)
    hand.move(hand.level.exits[0], wanted.exits[0])
    hand.choose("walls")
    for wall in wanted.walls:
        hand.draw_wall(wall.at, wall.side, wall.length)
    for size in ("small", "large"):
        hand.choose(size)
        hand.paint(*(puddle.at for puddle in wanted.puddles if puddle.size == size))
    path = tmp_path / "drawn.yaml"
    path.write_text(hand.editor.session.text, encoding="utf-8")
    assert load_file(path).digest == wanted.digest
    for command in (["format", "--check"], ["lint"]):
        result = babyrobot(*command, str(path))
        assert result.status == 0, result.out + result.err


@pytest.mark.parametrize("kind", swept([Keys, Finger], [Mouse]))
def test_a_region_is_copied_and_stamped_mirrored(kind: type[Hand], editor_page: OpenEditor) -> None:
    hand = kind(editor_page(ROOM, **kind.context))
    hand.copy((0, 0), (0, 1))
    if kind is Keys:
        hand.page.keyboard.press("h")
    else:
        hand.page.get_by_role("button", name="Mirror ↔").click()
    hand.paint((2, 0))
    level = hand.level
    assert [(wall.at, wall.side) for wall in level.walls] == [((0, 1), "E"), ((1, 1), "E")]
    assert [(item.name, item.at) for item in level.items] == [("key", (0, 1)), ("key-2", (2, 1))]
    said = hand.page.locator(".said")
    assert said.inner_text().startswith("Stamped at [2, 0]. Left out: a start.")
    hand.page.keyboard.press("Control+z")
    hand.page.wait_for_function(SAYS, arg="Undone: stamp")
    assert hand.editor.session.text == ROOM


@pytest.mark.parametrize("kind", swept([Finger], [Mouse]))
def test_a_second_robot_is_added_gets_an_exit_is_moved_and_erased(
    kind: type[Hand], editor_page: OpenEditor
) -> None:
    hand = kind(editor_page("version: 1\nsize: [4, 3]\n", **kind.context))
    hand.choose("robot")
    hand.paint((0, 2))
    hand.move((0, 2), (3, 0))
    hand.choose("small")
    hand.move((0, 2), (1, 2))
    hand.move((3, 0), (2, 0))
    assert hand.level.team_starts[1] == (hand.level.robots[1], (1, 2))
    assert hand.level.robots[1].exit == (2, 0)
    hand.choose("erase")
    hand.paint((1, 2))
    assert hand.level.robots == ()
    assert "an exit" in hand.page.locator(".said").inner_text()
