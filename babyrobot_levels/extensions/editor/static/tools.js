// The tools: what each sends for the spots that it was drawn over. Mouse, touch and keyboard use the
// same: `gestureOf(editor, spots)` returns the message, or null if there is nothing to do. While one
// still draws, it is the preview of what will be sent.

import { COMMON } from "../../../render/static/common.js";
import { copy } from "./region.js";
import { beyond, cellsAlong, isSameCell, runAlong, sidesOfRun, spotOf, usualSide } from "./spots.js";

/** The gestures of tools that neither build nor paint. */
const GESTURES = {
  erase: erased,
  select: moved,
  stamp: copied,
  robot: joined,
  warp: warped,
  path: walked,
  wind: () => null,
};

/** The tools in the order of the rail. @type {Tool[]} */
export const TOOLS = COMMON.tools.map((tool) => ({
  ...tool,
  gesture: tool.builds ? drawnWalls : (GESTURES[tool.name] ?? painted),
}));

/** What is drawn with a tool besides its place; the strip of options changes it. @type {Record<string, any>} */
export const DEFAULT_OPTIONS = {
  glass: { pass: 0.5 },
  area: { color: "#8fb996" },
  item: { shape: "key" },
  stamp: { mirror: "" },
};

/** Return a tool by its name. */
export function toolNamed(name) {
  return TOOLS.find((tool) => tool.name === name);
}

/**
 * Return the message for spots that were drawn over: the first is where it began.
 *
 * `erases` takes the eraser instead of the tool; `rectangle` and `fill` change what brushes do.
 *
 * @param {Editor} editor
 * @param {Spot[]} spots
 * @param {{ erases?: boolean, rectangle?: boolean, fill?: boolean }} [how]
 * @returns {Message | null}
 */
export function gestureOf(editor, spots, { erases = false, ...modifiers } = {}) {
  const tool = toolNamed(erases ? "erase" : editor.tool);
  if (spots[0].cell === null) return null;
  const isMove = cellsAlong(spots).length > 1 && takenAt(editor, spots[0], tool) !== null;
  if (isMove) return moved(editor, tool, spots);
  return tool.gesture(editor, tool, spots, { ...editor.modifiers, ...modifiers });
}

/** Send a message; if there is none, select what is where one clicked. */
export function sendOrSelect(editor, spots, message) {
  if (message?.do === "lift") copy(editor, message.cells);
  else if (message !== null) editor.send(message);
  else if (cellsAlong(spots).length === 1) selectAt(editor, spots[0]);
}

/** Select the topmost thing at a spot, or the one below that which is selected. */
export function selectAt(editor, spot) {
  const things = spot.cell === null ? [] : thingsAt(editor, spot);
  const at = things.findIndex((each) => sameRoute(each, editor.selection));
  editor.select(things[(at + 1) % things.length] ?? null);
}

const ENDS = ["start", "exit", "robot"];
const DRAGGED = ["erase", "robot", "warp", "path", "stamp"]; // Tools whose own drags begin anywhere.

/** Return what a drag from a spot moves, or null. Starts, exits and robots are moved by every tool for cells. */
export function takenAt(editor, spot, tool = toolNamed(editor.tool)) {
  if (tool.name === "select") return pickedAt(editor, spot);
  if (DRAGGED.includes(tool.name) || (tool.builds && spot.side !== null)) return null;
  return thingsAt(editor, { ...spot, side: null }).find(({ kind }) => ENDS.includes(kind)) ?? null;
}

export function drawnWalls(editor, tool, spots) {
  if (spots[0].side === null) return null;
  const to = tool.builds;
  const { pass } = editor.options.glass;
  const run = runAlong(spots, sizeOf(editor));
  const standing = wallAt(editor, ...firstOfRun(run, spots[0]));
  const removes = to === "wall" ? standing !== null : standing === to;
  return { do: "walls", ...run, to: removes ? "none" : to, ...(to === "glass" && !removes ? { pass } : {}) };
}

/** Return the side of a run at which it was begun: one of its ends. */
function firstOfRun(run, { at: [x, y] }) {
  const sides = sidesOfRun(run);
  const [distance, other] = [sides[0], sides.at(-1)].map(([cell, side]) => {
    const { at } = spotOf(cell, side);
    return Math.hypot(at[0] - x, at[1] - y);
  });
  return distance <= other ? sides[0] : sides.at(-1);
}

function painted(editor, tool, spots, { rectangle = false, fill = false }) {
  const fields = editor.options[tool.name];
  const cells = insideOf(editor, cellsAlong(spots));
  if (cells.length === 0) return null;
  const paint = fields === undefined ? { brush: tool.name } : { brush: tool.name, fields };
  if (fill && !tool.isSingle) return { do: "fill", ...paint, at: cells[0] };
  if (tool.isSingle)
    return { do: "paint", ...paint, cells: cells.slice(-1), ...(rectangle && tool.isMore ? { add: true } : {}) };
  if (rectangle || tool.isRectangle)
    return { do: "paint", ...paint, cells: cornersBetween(editor, spots), rectangle: true };
  return { do: "paint", ...paint, cells };
}

function erased(editor, tool, spots, modifiers) {
  const [{ cell, side }] = spots;
  if (side !== null && wallAt(editor, cell, side) !== null) {
    return { do: "walls", ...runAlong(spots, sizeOf(editor)), to: "none" };
  }
  return painted(editor, tool, spots, modifiers);
}

function moved(editor, tool, spots) {
  const [first, last] = [spots[0], spots.at(-1)];
  const thing = takenAt(editor, first, tool);
  if (thing === null || last.cell === null || isSameCell(first.cell, last.cell)) return null;
  return { do: "move", route: thing.route, from: first.cell, to: last.cell };
}

function warped(editor, tool, spots) {
  const [first, last] = [spots[0], spots.at(-1)];
  if (last.cell === null || isSameCell(first.cell, last.cell)) return null;
  return { do: "warp", at: first.cell, to: last.cell };
}

function joined(editor, tool, spots) {
  const [{ cell: at }, { cell: to }] = [spots[0], spots.at(-1)];
  if (to === null) return null;
  if (!isSameCell(at, to)) return { do: "robot", at, to };
  const isThere = thingsAt(editor, { cell: at, side: null }).some(({ kind }) => kind === "robot");
  return isThere ? null : { do: "robot", at };
}

function walked(editor, tool, spots, { rectangle }) {
  if (rectangle) return { do: "path", cells: cornersBetween(editor, spots), rectangle };
  const cells = insideOf(editor, cellsAlong(spots));
  return cells.length < 2 ? null : { do: "path", cells };
}

function copied(editor, tool, spots) {
  const isClick = cellsAlong(spots).length === 1;
  if (isClick && editor.region !== null) return { do: "stamp", at: spots[0].cell, ...editor.options.stamp };
  return { do: "lift", cells: cornersBetween(editor, spots) };
}

/** @param {Editor} editor @returns {[number, number]} */
export function sizeOf({ game: { data } }) {
  return [data.width, data.height];
}

/** Return whether a cell is in the level. */
export function isInside(editor, cell) {
  const size = sizeOf(editor);
  return cell.every((place, axis) => place >= 0 && place < size[axis]);
}

/** Return those of some cells that are in the level. */
export function insideOf(editor, cells) {
  return cells.filter((cell) => isInside(editor, cell));
}

function cornersBetween(editor, spots) {
  const size = sizeOf(editor);
  return [spots[0], spots.at(-1)].map(({ at }) =>
    at.map((place, axis) => Math.min(size[axis] - 1, Math.max(0, Math.floor(place)))),
  );
}

/** Return the entries of `state.places` at a spot, the topmost first: those of the side, if one is meant. */
export function thingsAt(editor, { cell, side }) {
  const places = editor.state.places ?? [];
  const isOfSide = ({ kind }) => COMMON.at_sides.includes(kind);
  const found = side === null ? [] : places.filter((place) => isOfSide(place) && isAtSide(place, cell, side));
  const inside = places
    .filter((place) => !isOfSide(place) && place.cells.some((each) => isSameCell(each, cell)))
    .sort((one, other) => COMMON.on_top.indexOf(one.kind) - COMMON.on_top.indexOf(other.kind));
  return [...found, ...inside];
}

function isAtSide({ sides }, cell, side) {
  const [[x, y], usual] = usualSide(cell, side);
  return sides.some((each) => each[0] === x && each[1] === y && each[2] === usual);
}

/** Return the selected entry if it is at a spot, else the topmost one there, or null. */
function pickedAt(editor, spot) {
  const things = thingsAt(editor, spot);
  return things.find((each) => sameRoute(each, editor.selection)) ?? things[0] ?? null;
}

export function sameRoute(one, other) {
  return one !== null && other !== null && one.route.join("\n") === other.route.join("\n");
}

/** Return what is at a side: "wall", "glass", "door", or null. Of a maze as well. */
export function wallAt(editor, cell, side) {
  const entry = thingsAt(editor, { cell, side }).find(({ kind }) => kind === "door" || kind === "wall");
  if (entry?.kind === "door") return "door";
  if (entry?.fields?.pass > 0) return "glass";
  const next = beyond(cell, side);
  if (!isInside(editor, next)) return "wall";
  const { possible, width } = editor.game.data;
  // From an exit nothing is possible, but from beside it.
  const isOpen = ([x, y], action) => ((possible[y * width + x] >> action) & 1) === 1;
  const action = "-NESW".indexOf(side);
  return isOpen(cell, action) || isOpen(next, ((action + 1) % 4) + 1) ? null : "wall";
}

/** Return the tool with which what is at a spot was drawn, and its options; or null. */
export function toolAt(editor, spot) {
  const [thing] = thingsAt(editor, spot);
  const wall = spot.side === null ? null : wallAt(editor, spot.cell, spot.side);
  if (wall !== null)
    return {
      tool: wall === "wall" ? "walls" : wall,
      options: wall === "glass" ? { pass: thing?.fields?.pass ?? 0.5 } : {},
    };
  const { kind, fields = {} } = thing ?? {};
  const names = { puddle: fields.size ?? "small", mover: "path", opening: "walls" };
  const tool = toolNamed(names[kind] ?? kind);
  if (tool === undefined) return null;
  const options = DEFAULT_OPTIONS[tool.name] ?? {};
  return {
    tool: tool.name,
    options: Object.fromEntries(Object.keys(options).map((name) => [name, fields[name] ?? options[name]])),
  };
}
