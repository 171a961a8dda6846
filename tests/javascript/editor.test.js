import assert from "node:assert/strict";
import { test } from "node:test";
import { changed } from "../../babyrobot_levels/extensions/editor/static/differences.js";
import { ACTIONS } from "../../babyrobot_levels/extensions/editor/static/keys.js";
import {
  cellsAlong,
  runAlong,
  sidesOfRun,
  spotAt,
  spotOf,
  usualSide,
} from "../../babyrobot_levels/extensions/editor/static/spots.js";
import { markOf, plainLines } from "../../babyrobot_levels/extensions/editor/static/yaml_lines.js";
import { editorData } from "./page.js";

test("a spot has its cell, and the side that is near", () => {
  assert.deepEqual(spotAt([1.5, 0.1], [3, 2]), { at: [1.5, 0.1], cell: [1, 0], side: "N", rim: null });
  assert.equal(spotAt([1.5, 0.5], [3, 2]).side, null);
});

test("a spot outside has the rim", () => {
  assert.deepEqual(spotAt([3.4, 1.2], [3, 2]), { at: [3.4, 1.2], cell: null, side: null, rim: "E" });
});

test("a side between cells belongs to the one in the north or west", () => {
  assert.deepEqual(usualSide([1, 1], "N"), [[1, 0], "S"]);
  assert.deepEqual(usualSide([1, 1], "W"), [[0, 1], "E"]);
  assert.deepEqual(usualSide([0, 0], "W"), [[0, 0], "W"]);
});

test("a line passes through neighbours, each once", () => {
  const cells = cellsAlong([spotOf([0, 0]), spotOf([3, 1]), spotOf([0, 0])]);
  assert.deepEqual([cells[0], cells.length], [[0, 0], new Set(cells.map(String)).size]);
  assert.ok(cells.some((cell) => String(cell) === "3,1"));
});

test("a run lies along the side at which it began", () => {
  const run = runAlong([spotOf([0, 0], "S"), spotOf([2, 0], "S")], [3, 2]);
  assert.deepEqual(run, { at: [0, 0], side: "S", length: 3 });
  assert.deepEqual(sidesOfRun(run), [
    [[0, 0], "S"],
    [[1, 0], "S"],
    [[2, 0], "S"],
  ]);
});

test("a drawing is a text that is written as it is", () => {
  assert.deepEqual(plainLines(["drawing: |", "  S . E", "", "name: a"]), [false, true, true, false]);
});

test("marks count characters as the editor of texts does", () => {
  const finding = { line: 1, column: 3, end_line: 1, end_column: 5, severity: "error" };
  assert.deepEqual(markOf(finding, ["\u{1f916}\u{1f916} ab"]), { from: 4, to: 6, kind: "mark error" });
});

// As `tests/extensions/editor/test_differences.py` has them.
const DIFFERENCES = [
  [
    { a: 1, b: [1, 2] },
    { a: [], c: [2], b: { 1: [3] } },
    { b: [1, 3], c: 2 },
  ],
  [
    [1, 2, 3, 4],
    [2, 2, [5]],
    [1, 2, 5, 3, 4],
  ],
  ["size: 3", [6, 6, "2"], "size: 23"],
  ["an é", ["an è"], "an è"],
  [{ a: { b: [[1]] } }, { a: { b: [0, 1, [[2], 3]] } }, { a: { b: [[2], 3] } }],
];

for (const [before, changes, after] of DIFFERENCES) {
  test(`a value has changed to ${JSON.stringify(after)}`, () => {
    const kept = structuredClone(before);
    assert.deepEqual(changed(before, changes), after);
    assert.deepEqual(before, kept);
  });
}

// As keys are shown, and what one of them is called.
const CALLED = { "← ↑ → ↓": "ArrowUp", arrow: "ArrowUp", "Page up": "PageUp", "Page down": "PageDown", "−": "-" };

for (const { title, keys } of editorData("keys.json").filter(({ title }) => title !== "Text")) {
  test(`the keys that are listed under ${title} do something`, () => {
    const known = new Set(Object.values(ACTIONS).flatMap((actions) => Object.keys(actions)));
    const shown = keys.flatMap(([each]) => each.split(/, | or /)).map((each) => each.replaceAll(" + ", "+"));
    for (const each of shown) {
      const name = each.replace(/← ↑ → ↓|arrow|Page up|Page down/, (found) => CALLED[found]);
      for (const key of name.split(" ")) assert.ok(known.has(CALLED[key] ?? key), key);
    }
  });
}
