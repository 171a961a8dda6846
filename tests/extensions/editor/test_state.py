"""Which colours of a theme stand out."""

from __future__ import annotations

from pathlib import Path

import pytest

from babyrobot_levels.extensions.editor.protocol import answer
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.sources import session_of
from babyrobot_levels.extensions.editor.state import contrasts, state_of
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_the_colours_of_built_in_themes_stand_out(name: str) -> None:
    assert [each for each in contrasts(BUILTIN_THEMES[name]) if not each["is_enough"]] == []


@pytest.mark.parametrize(
    ("colors", "faint"),
    [
        ({"walls": "#ff9900"}, {"walls"}),
        ({"exit_text": "#44aa44"}, {"exit_text"}),
        ({"robot": "orange", "puddle": "orange"}, {"robot", "puddle"}),
    ],
)
def test_colours_that_do_not_are_told(colors: dict[str, str], faint: set[str]) -> None:
    theme = Theme.model_validate({"colors": colors})
    assert {each["color"] for each in contrasts(theme) if not each["is_enough"]} == faint


def test_a_ratio_is_never_rounded_up_to_what_is_needed() -> None:
    theme = Theme.model_validate({"colors": {"base": "#ffffff", "walls": "#959595"}})
    (walls,) = (each for each in contrasts(theme) if each["color"] == "walls")
    assert walls["ratio"] < walls["least"]
    assert not walls["is_enough"]


def test_the_state_has_the_colours_of_a_theme_that_is_named() -> None:
    state = state_of(Session("version: 1\ntheme: green\n"))
    assert state["theme"]["colors"]["base"] == BUILTIN_THEMES["green"].colors.base
    assert {each["color"] for each in state["contrast"]} >= {"walls", "start_text"}


def test_themes_in_files_beside_the_level_can_be_chosen(tmp_path: Path) -> None:
    (tmp_path / "themes").mkdir()
    (tmp_path / "themes" / "ours.yaml").write_text("colors: {base: '#123456'}\n", "utf-8")
    (tmp_path / "themes" / "bad.yaml").write_text("colors: 7\n", "utf-8")
    path = tmp_path / "level.yaml"
    path.write_text("version: 1\n", "utf-8")
    session = session_of(path)
    themes = answer(session, {"do": "state"})["state"]["themes"]
    assert {name: theme["colors"]["base"] for name, theme in themes.items()} == {"ours": "#123456"}
    message = {"do": "set", "route": ["theme"], "value": "ours", "revision": session.revision}
    assert answer(session, message)["state"]["theme"]["colors"]["base"] == "#123456"
    assert answer(Session("version: 1\n"), {"do": "state"})["state"]["themes"] == {}
