// What is told to people who do not see the picture: what changed, and what is in a cell.

import { COMMON } from "../../../render/static/common.js";
import { readOut } from "../../../render/static/dom.js";
import { capital } from "../../../render/static/game.js";
import { listed } from "../../../render/static/things.js";
import { isSameCell, SIDE_NAMES, sidesOfRun } from "./spots.js";
import { thingsAt, toolNamed, wallAt } from "./tools.js";

/** Return a cell as it is written in level files. */
export function cellName([x, y]) {
  return `[${x}, ${y}]`;
}

/** Return what a side of a cell is: "open", "wall", or what is said of glass and doors. */
function sideInWords(editor, cell, side) {
  const wall = wallAt(editor, cell, side);
  if (wall === null || wall === "wall") return wall ?? "open";
  return thingsAt(editor, { cell, side }).find(({ kind }) => kind === "wall" || kind === "door").label;
}

/** Describe a cell: what stands in it, what closes its sides, and what is wrong there. */
function cellInWords(editor, cell) {
  const { unreachable = [], findings } = editor.state;
  const isHere = (cells = []) => cells.some((each) => isSameCell(each, cell));
  const inside = thingsAt(editor, { cell, side: null }).map(({ label }) => label);
  const sides = [..."NESW"].map((side) => [SIDE_NAMES[side], sideInWords(editor, cell, side)]);
  const kinds = [...new Set(sides.map(([, what]) => what))].filter((what) => what !== "open");
  return [
    `${cellName(cell)}: ${inside.length > 0 ? listed(inside) : "empty"}`,
    ...kinds.map((kind) => `${listed(sides.filter(([, what]) => what === kind).map(([name]) => name))}: ${kind}`),
    ...(isHere(unreachable) ? ["cannot be reached"] : []),
    ...findings.filter(({ cells }) => isHere(cells)).map(({ severity, message }) => `${severity}: ${message}`),
  ].join("; ");
}

/** Return the cells of a gesture in words. */
function cellsInWords(cells, isRectangle = false) {
  const [first, last] = [cells[0], cells.at(-1)];
  if (cells.length === 1 || isSameCell(first, last)) return cellName(first);
  if (isRectangle) return `all cells from ${cellName(first)} to ${cellName(last)}`;
  return `${cells.length} cells from ${cellName(first)} to ${cellName(last)}`;
}

function wallsInWords(editor, run) {
  const sides = sidesOfRun(run);
  const [[first, side], [last]] = [sides[0], sides.at(-1)];
  const place = sides.length === 1 ? `side of ${cellName(first)}` : `sides of ${cellName(first)} to ${cellName(last)}`;
  return `${capital(SIDE_NAMES[side])} ${place}: ${sideInWords(editor, first, side)}`;
}

/** Return what a brush does, before where it does it. */
function brushInWords(brush) {
  return brush === "erase" ? "Erased" : `${toolNamed(brush).title} in`;
}

function windInWords({ side, index, strength }) {
  const line = `${"NS".includes(side) ? "column" : "row"} ${index}`;
  return strength === 0 ? `No wind in ${line}` : `Wind of ${strength} to the ${SIDE_NAMES[side]} in ${line}`;
}

/** What messages to Python did, in words; without any for what is typed, which is its own. */
const DONE = {
  walls: (editor, run) => wallsInWords(editor, run),
  paint: (editor, { brush, cells, rectangle }) => `${brushInWords(brush)} ${cellsInWords(cells, rectangle)}`,
  fill: (editor, { brush, at }) => `${brushInWords(brush)} ${cellName(at)} and all cells like it around it`,
  warp: (editor, { at, to }) => `Warp from ${cellName(at)} to ${cellName(to)}`,
  robot: (editor, { at, to }) => `Robot at ${cellName(at)}${to === undefined ? "" : ` leaves at ${cellName(to)}`}`,
  path: (editor, { cells, rectangle }) => `Mover ${rectangle ? "in" : "through"} ${cellsInWords(cells, rectangle)}`,
  stamp: (editor, { at }) => `Stamped at ${cellName(at)}`,
  move: (editor, { from, to }) => `Moved from ${cellName(from)} to ${cellName(to)}`,
  remove: () => "Removed",
  set: (editor, { route, value }) =>
    value === null ? `${fieldInWords(route)} removed` : `${fieldInWords(route)} set${written(value)}`,
  resize: (editor, { size: [columns, rows] }) => `The level is ${columns} by ${rows} cells`,
  wind: (editor, gesture) => windInWords(gesture),
  resolve: () => "The maze is written out as walls",
  keep_maze: () => "The maze is written out as walls, as it was before the last gesture",
  fix: () => "The finding is fixed",
  open: () => "Opened",
  undo: (editor, { step }) => `Undone${step ? `: ${COMMON.steps_undone[step]}` : ""}`,
  redo: (editor, { step }) => `Done again${step ? `: ${COMMON.steps_undone[step]}` : ""}`,
};

const MODES_IN_WORDS = { edit: "Editing.", play: "Playing.", policy: "Drawing a policy." };

/** Return the name of the field at the end of a route. */
function fieldInWords(route) {
  return capital(String(route.at(-1)).replaceAll("_", " "));
}

/** Return a value in words; a mapping is too long for any. */
function written(value) {
  if (Array.isArray(value)) return ` to ${value.join(", ")}`;
  return typeof value === "object" ? "" : ` to ${value}`;
}

/** Says what was done, and what is in the cell of the cursor as it moves. */
export class Announcer {
  constructor(editor, place) {
    this.editor = editor;
    this.place = place;
    this.cell = editor.cursor.cell;
    this.route = null; // Of what is selected.
    this.count = 0; // Of findings.
    editor.on("done", () => this.tellDone());
    editor.on("cursor", () => this.tellCell());
    editor.on("look", () => editor.game && this.speak(cellInWords(editor, editor.cursor.cell)));
    editor.on("selection", () => this.tellSelection());
    editor.on("mode", () => this.speak(MODES_IN_WORDS[editor.mode]));
  }

  tellDone() {
    const { editor } = this;
    const { length: count } = editor.state.findings;
    const done = DONE[editor.done.do]?.(editor, editor.done);
    const { maze_regrown: isGrown, lost, left } = editor.state;
    const words = [
      done,
      lost && `This also removed ${lost}`,
      left && `Left out: ${left}`,
      isGrown && "The maze has grown anew",
      count !== this.count && (count === 0 ? "No findings" : `Findings: ${count}`),
    ].filter(Boolean);
    if (done !== undefined) editor.say(words.map((each) => `${each}.`).join(" "));
    else if (editor.saidKind === "refused") editor.say(""); // It was about what was before.
    this.count = count;
  }

  tellCell() {
    const { cell } = this.editor.cursor;
    if (this.editor.game && !isSameCell(cell, this.cell)) this.speak(cellInWords(this.editor, cell));
    this.cell = cell;
  }

  tellSelection() {
    const { selection } = this.editor;
    const route = selection?.route.join() ?? null;
    if (route !== this.route) this.speak(selection === null ? "Nothing is selected." : `Selected: ${selection.label}.`);
    this.route = route;
  }

  speak(words) {
    readOut(this.place, words);
  }
}
