"""The page of a class: points, what does not count, and names of strangers as plain text."""

from __future__ import annotations

from pathlib import Path

from support.plays import record

import babyrobot_levels as brl
from babyrobot_levels.extensions.scoring.class_page import class_page

LEVELS = ({"version": 1, "size": [3, 1], "max_steps": 9, "name": name} for name in ("row", "lane"))


def test_a_page_has_all_points_and_what_does_not_count(tmp_path: Path) -> None:
    row, lane = (brl.load(level) for level in LEVELS)
    for name in ("<b>Ada", "=1+1"):
        (tmp_path / name).mkdir()
        record(tmp_path / name / "row.brlplay", row, episodes=3)
    (tmp_path / "<b>Ada" / "<i>.brlplay").write_bytes(b"")
    grades = brl.grade([tmp_path], [row, lane.replace(rewards={"step": -2})])
    page = class_page(grades)
    assert "<b>" not in page
    assert "<i>" not in page
    assert "&lt;b&gt;Ada" in page
    assert "&lt;i&gt;.brlplay" in page
    assert "the file is empty" in page
    assert '<th scope="row">Possible</th><td>1</td><td>1</td><td>2</td>' in page
    assert "2 players" in page
    assert "script" not in page
    # Nor is a name a formula in a spreadsheet.
    assert "\n'=1+1," in grades.totals_to_csv()
    assert "\n'=1+1," in grades.to_csv()
