"""The ways to hand in something wrong, one by one: what each student reads.

A sentence says what is expected, what is there, and what to do. It is that of the first function
of which it is not that there is no such file.
"""

from __future__ import annotations

import io
import json
import shutil
import zipfile
from pathlib import Path
from typing import Any

import pytest
from support.places import ROOT, TESTS

import babyrobot_levels as brl

FILES = TESTS / "cli" / "files"
RIGHT = (FILES / "handed-in" / "ada" / "value_iteration.py").read_text("utf-8")
STARTER = (ROOT / "course" / "value_iteration.py").read_text("utf-8")
COURSE = """\
name: one
version: 1.0.0
description: One level, three by two.
functions: {value_iteration: values, policy_iteration: policy, q_learning: agent}
levels: [{level: bend, points: 6}]
"""


def notebook(*cells: str) -> str:
    found = [{"cell_type": "code", "source": cell} for cell in cells]
    return json.dumps({"cells": found, "nbformat": 4})


def zipped(name: str, data: str | bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr(name, data)
    return out.getvalue()


def values(body: str) -> dict[str, Any]:
    text = f"import numpy as np\ndef value_iteration(level):\n    {body}\n"
    return {"value_iteration.py": text}


def policy(body: str) -> dict[str, Any]:
    return {"policy_iteration.py": f"def policy_iteration(level):\n    {body}\n"}


def agent(body: str) -> dict[str, Any]:
    text = f"import numpy as np\ndef q_learning(level):\n    {body}\n"
    return {"q_learning.py": text}


READ = "all 6 values are right"
SHAPE = "the values must be an array [2, 3], not"
WANTED = "hand in .brlplay, .py, .ipynb, .json, .npy or .npz files, or a .zip of them"
NOTHING = "there is no file to grade, but"
DEFINE = "write `def value_iteration(level):`"
RETURNED = "return an array, a number for each state"
POLICY = (
    "a policy for this level and actions='all' is an array [2, 3] of actions, or an array "
    "[2, 3, 5] or [6, 5] of probabilities, not"
)
ACTIONS = "0 stay, 1 north, 2 east, 3 south, 4 west"

WAYS: dict[str, tuple[dict[str, Any], str]] = {
    # What is read all the same: the second sentence is the note.
    "another name": ({"homework.py": RIGHT}, f"{READ}; value_iteration was read from homework.py"),
    "a folder too deep": ({"hw/robots/value_iteration.py": RIGHT}, READ),
    "txt behind": ({"value_iteration.py.txt": RIGHT},
                   f"{READ}; value_iteration.py.txt: its name ends in .txt"),
    "a byte order mark": ({"value_iteration.py": b"\xef\xbb\xbf" + RIGHT.encode()},
                          f"{READ}; value_iteration.py: it has a byte order mark"),
    "a notebook": ({"hw.ipynb": notebook("1 / 0", RIGHT)},
                   f"{READ}; value_iteration was read from hw.ipynb"),
    "two versions": ({"value_iteration.py": RIGHT, "old/value_iteration.py": "\n" + RIGHT},
                     f"{READ}; value_iteration is in several files: it was read from "
                     "value_iteration.py, not old/value_iteration.py"),
    # What cannot be read is no 0.
    "another archive": ({"work.rar": "Rar!"}, f"not graded: {NOTHING} work.rar: {WANTED}"),
    "a document": ({"report.pdf": "%PDF"}, f"not graded: {NOTHING} report.pdf: {WANTED}"),
    "a zip in a zip": ({"work.zip": zipped("inner.zip", zipped("value_iteration.py", RIGHT))},
                       "not graded: a zip file in the zip file of a player is not read"),
    "half a zip": ({"work.zip": zipped("value_iteration.py", RIGHT)[:60]},
                   "not graded: the zip file is damaged (File is not a zip file)"),
    # Files and functions of other names.
    "another file": ({"main.py": "x = 1"},
                     "there is no value_iteration.py, but main.py, and none of the files has a "
                     "function value_iteration"),
    "another function": ({"value_iteration.py": "def valueIteration(level): return 1\n"},
                         "value_iteration.py has no function value_iteration, but valueIteration: "
                         "call it value_iteration"),
    "a method": ({"value_iteration.py": "class A:\n    def value_iteration(self): pass\n"},
                 "value_iteration.py has no function value_iteration: "
                 f"{DEFINE} at the left margin"),
    "two arguments": ({"value_iteration.py": "def value_iteration(level, gamma): return 1\n"},
                      f"it is `def value_iteration(level, gamma):`: {DEFINE}, as it is called with "
                      "the level alone"),
    "unchanged": ({"value_iteration.py": STARTER}, "it is not written yet"),
    # What does not run.
    "no colon": ({"value_iteration.py": "def value_iteration(level)\n    return 1\n"},
                 "SyntaxError: expected ':' (value_iteration.py, line 1)"),
    "a library": (values("import nowhere"),
                  "ModuleNotFoundError in value_iteration.py, line 3: No module named 'nowhere': "
                  "it is neither among the files that were handed in nor installed here"),
    "a file of mine": (values("return np.loadtxt('values.txt')"),
                       "FileNotFoundError in value_iteration.py, line 3: values.txt not found.: "
                       "only what was handed in is there"),
    "a misspelt name": (values("return level.things_"),
                        "AttributeError in value_iteration.py, line 3: 'Level' object has no "
                        "attribute 'things_'; did you mean `things`?"),
    "changed tables": (values("level.compile().reward[0] = 1"),
                       "ValueError in value_iteration.py, line 3: assignment destination is "
                       "read-only: the tables of a level cannot be changed, but copied"),
    "a question": (values("input()"),
                   "EOFError in value_iteration.py, line 3: EOF when reading a line: nobody can "
                   "type while it is graded"),
    "an end": (values("raise SystemExit('done')"),
               "SystemExit in value_iteration.py, line 3: done: `return` the answer, and do not "
               "end Python"),
    "no end": (values("while True: pass"), "it took longer than 3 seconds"),
    # What is returned is no array.
    "no return": (values("print([1, 2])"), "it returns nothing: it has to end with `return`"),
    "tuples as keys": (values("return {(0, 0): 1.0}"), f"it returns a dict: {RETURNED}"),
    "an object": (values("return level"), f"it returns a Level: {RETURNED}"),
    "None among them": (values("return [[None, 1, 2], [0, 1, 2]]"),
                        f"it returns a list of NoneType: {RETURNED}"),
    "ragged rows": (values("return [[1, 2], [3]]"), "it returns rows that differ in length"),
    # An array of something else.
    "one number": (values("return 3"), f"{SHAPE} a single number"),
    "rows for columns": (values("return np.zeros((3, 2))"),
                         f"{SHAPE} one of shape [3, 2]; rows come first: values[y, x]"),
    "action values": (values("return np.zeros((2, 3, 5))"),
                      f"{SHAPE} one of shape [2, 3, 5]: of action values, a state takes the "
                      "largest"),
    "a column": (values("return np.zeros((6, 1))"),
                 f"{SHAPE} one of shape [6, 1]: reshape it to (2, 3)"),
    "values and policy": (values("return np.zeros((2, 3)), np.zeros((2, 3))"),
                          f"{SHAPE} one of shape [2, 2, 3]: these are 2 arrays, return the values "
                          "alone"),
    "names for values": (values("return [['east'] * 3] * 2"),
                         "the values are not numbers in a table, but such as east"),
    "nan": (values("return np.full((2, 3), np.nan)"),
            "the value of [0, 0] is not a number (nan)"),
    "other directions": (policy("return [['right'] * 3] * 2"),
                         "'right' is none of the actions stay, north, east, south, west, or of "
                         "their numbers 0 to 4"),
    "no such number": (policy("return [[5] * 3] * 2"),
                       f"the policy's action at [0, 0] is 5; actions='all' has {ACTIONS}"),
    "values for a policy": (policy("return [[-2.5, -1.5, 0.0], [-3.0, -2.1, -1.0]]"),
                            "a policy [height, width] is an array of actions, integers or names, "
                            "not of values such as -2.5"),
    "one action": (policy("return 'east'"), f"{POLICY} 'east'"),
    "a policy and values": (policy("return [[2, 2, 0], [2, 2, 1]], [[0, 0, 0], [0, 0, 0]]"),
                            f"{POLICY} one of shape [2, 2, 3]: these are 2 arrays, give the policy "
                            "alone"),
    "a table of Q": (agent("return np.zeros((6, 5))"),
                     "the policy's probabilities at [0, 0] are [0.0, 0.0, 0.0, 0.0, 0.0]; they "
                     "must not be negative and add up to 1; of action values, give the largest "
                     "ones: values.argmax(axis=-1)"),
    "the mask": (agent("mdp = level.compile(); values = np.where(mdp.action_mask, -1.0, 0.0); "
                       "return values.argmax(axis=1)"),
                 "the agent covers nothing of the way from the random policy to the optimum, "
                 "where 95 % are needed; it reaches an exit in 0 % of the episodes; some of its "
                 "episodes never end; it takes impossible actions in 5 states: leave them out of "
                 "the maximum"),
    # Answers in place of code.
    "another level": ({"value_iteration.json": '{"Bend": [[1]]}'},
                      "value_iteration.json has no table of bend, but of Bend"),
    "one table": ({"value_iteration.json": "[[1, 2]]"},
                  "value_iteration.json has one table: give one for each level, by its name"),
    "half a file": ({"value_iteration.json": "[[1, 2"},
                    'value_iteration.json has no tables by the names of levels, such as {"NAME": '
                    "[[0, 1]]}"),
}  # fmt: skip


def first_told(found: brl.Submission) -> str:
    """Return the sentence of the function that was handed in, and the notes."""
    rows = [each for each in found if "there is no" not in each.message] or [*found]
    notes = [each for each in found.notes if not each.startswith("answers of")]
    return "; ".join([rows[0].message, *notes])


@pytest.mark.slow
def test_each_way_to_hand_in_something_wrong_is_answered(tmp_path: Path) -> None:
    course = tmp_path / "course"
    (course / "levels").mkdir(parents=True)
    (course / "pack.yaml").write_text(COURSE, "utf-8")
    shutil.copy(FILES / "course" / "levels" / "bend.yaml", course / "levels")
    for way, (files, _) in WAYS.items():
        for name, data in files.items():
            path = tmp_path / "class" / way / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data.encode() if isinstance(data, str) else data)
    found = brl.grade(tmp_path / "class", course, seconds=3, jobs=2)
    told = {way: first_told(found.submissions[way]) for way in WAYS}
    assert told == {way: sentence for way, (_, sentence) in WAYS.items()}
