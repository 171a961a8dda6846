"""Plans of multi-agent path finding: their texts, their faults, and what they cost."""

from __future__ import annotations

from itertools import pairwise, product
from pathlib import Path
from random import Random
from typing import Any

import pytest
from support.sessions import FILES

import babyrobot_levels as brl

LANE = FILES / "agents-on-maps"
SCEN = LANE / "lane.scen"
MOVES = ("rrdurr", "lwlll")
PATHS = [
    [(0, 0), (1, 0), (2, 0), (2, 1), (2, 0), (3, 0), (4, 0)],
    [(4, 0), (3, 0), (3, 0), (2, 0), (1, 0), (0, 0)],
]
Path2 = list[tuple[int, int]]


def written(folder: Path, text: str, name: str = "plan.txt") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def planner_text(paths: list[Path2]) -> str:
    steps = max(map(len, paths))
    rows = [[path[min(time, len(path) - 1)] for path in paths] for time in range(steps)]
    told = ["".join(f"({x},{y})," for x, y in row) for row in rows]
    return "solution=\n" + "".join(f"{time}:{row}\n" for time, row in enumerate(told))


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(MOVES),
        "2rdu2r\r\nlw3l\r\n",
        planner_text(PATHS),
        'agents,path\n1,rrrr\n2,"rrdurr\nlwlll"\n',
        # As it was published before the tracker had a column for it: `u` goes down.
        'agents,solution_plan\n2,"rrudrr\nlwlll"\n',
        'solution_plan,flip_up_down\n"rrudrr\nlwlll",TRUE\n',
        "map_name,scen_type,type_id,agents,solution_plan\n"
        'lane,even,1,2,"rrrr\nllll"\nlane,,,2,"rrdurr\nlwlll"\n'.replace("lane,,,", "lane,odd,2,"),
    ],
)
def test_plans_are_read_in_each_form(text: str, tmp_path: Path) -> None:
    scen = written(tmp_path, SCEN.read_text(encoding="utf-8"), "lane-odd-2.scen")
    found = brl.check_plan(written(tmp_path, text), scen, LANE / "lane.map", agents=2)
    assert found == brl.PlanCheck(2, None, 11, 6, 8, 4)
    assert found.is_valid


@pytest.mark.parametrize(
    ("paths", "kind", "agents", "time"),
    [
        ([PATHS[0], [(3, 0)]], "start", (2,), 0),
        ([[(0, 0), (-1, 0)], PATHS[1]], "outside", (1,), 1),
        ([[(0, 0), (0, 1)], PATHS[1]], "blocked", (1,), 1),
        ([[(0, 0), (2, 0)], PATHS[1]], "jump", (1,), 1),
        ([[(0, 0), (1, 0), (2, 0)], [(4, 0), (3, 0), (2, 0)]], "vertex", (1, 2), 2),
        ([PATHS[0][:3], [(4, 0), (3, 0), (3, 0), (2, 0)]], "vertex", (1, 2), 3),
        ([[(0, 0), (1, 0), (2, 0), (3, 0)], PATHS[1]], "edge", (1, 2), 3),
        ([PATHS[0][:-1], PATHS[1]], "goal", (1,), 5),
    ],
)
def test_the_first_fault_is_told(
    paths: list[Path2], kind: str, agents: tuple[int, ...], time: int
) -> None:
    fault = brl.check_plan(paths, SCEN).fault
    assert fault is not None
    assert (fault.kind, fault.agents, fault.time) == (kind, agents, time)


def conflicts(paths: list[Path2]) -> bool:
    """Return whether two agents are in one cell, or change places, by looking at each pair."""
    pairs = [(one, other) for n, one in enumerate(paths) for other in paths[:n]]
    meet = any(a == b for one, other in pairs for a, b in zip(one, other, strict=True))
    swap = any(
        a[::-1] == b
        for one, other in pairs
        for a, b in zip(pairwise(one), pairwise(other), strict=True)
    )
    return meet or swap


@pytest.mark.slow
def test_conflicts_are_those_of_each_pair(tmp_path: Path) -> None:
    random, cells = Random(0), [*product(range(3), range(2))]
    written(tmp_path, "type tile\nheight 2\nwidth 3\nmap\n...\n...\n", "a.map")
    valid = 0
    for _ in range(150):
        paths: list[Path2] = [[cell] for cell in random.sample(cells, random.randint(2, 3))]
        for path in paths * 2:
            x, y = path[-1]
            path.append(random.choice([(i, j) for i, j in cells if abs(i - x) + abs(j - y) < 2]))
        lines = [f"0 a.map 3 2 {a} {b} {c} {d} 0\n" for (a, b), *_, (c, d) in paths]
        scen = written(tmp_path, "version 1\n" + "".join(lines), "a.scen")
        found = brl.check_plan(paths, scen)
        assert found.is_valid is not conflicts(paths)
        valid += found.is_valid
    assert 30 < valid < 120


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("rrdurr\nlwxll\n", r"plan.txt:2:3: error: this is none of the moves"),
        ("rrdurr\n99999l99999l\n", r"plan.txt:1:1: error: 2 agents and 199,998 steps are too many"),
        ('agents,path\n2,"rr\nlwxll"\n', r"plan.txt:3:3: error: this is none of the moves"),
        ('agents,path\n2,"rr"x\n', r"plan.txt:2:7: error: a comma or the end"),
        ("agents,plan\n2,rr\n", r"plan.txt:1:1: error: there is no column solution_plan"),
        ("solved=0\nsolution=\n", r"plan.txt:2:1: error: the planner found no solution"),
        ("solution=\n0:(0,0),(4,0),\n2:(1,0),", r"plan.txt:3:1: error: the time 2 follows 1"),
        ("solution=\n0:(0,0),(4,0),\n1:(1,0),", r"plan.txt:3:1: error: 1 agents have a place"),
        ("solution=\n0:(0,0)->(1,0)", r"plan.txt:2:8: error: this is no `TIME"),
        ("r\nl\nw\n", r"plan.txt:1:1: error: the plan is for 3 agents, and there are 2 scen"),
    ],
)
def test_what_is_no_plan_is_refused_at_its_place(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(brl.ConversionError, match=message):
        brl.check_plan(written(tmp_path, text), SCEN)


def test_a_scenario_must_be_on_its_map(tmp_path: Path) -> None:
    lines = SCEN.read_text(encoding="utf-8").replace("\t4\t0\t4", "\t3\t1\t4")
    scen = written(tmp_path, lines, "lane.scen")
    with pytest.raises(brl.ConversionError, match=r"lane.scen:2:1: error: \[3, 1\] is no free"):
        brl.check_plan(PATHS, scen, LANE / "lane.map")
    wrong: list[Any] = [[], [[]], [[(0.5, 0)]], [[0, 1]]]
    for paths in wrong:
        with pytest.raises(ValueError, match="plan"):
            brl.check_plan(paths, SCEN)
