// The tools: what each sends for the spots that it was drawn over. Mouse, touch and keyboard use the
// same: `gestureOf(editor, spots)` returns the message, or null if there is nothing to do. While one
// still draws, it is the preview of what will be sent.

import { COMMON } from "../../../render/static/common.js";
import { copy } from "./region.js";
import { beyond, cellsAlong, isSameCell, runAlong, sidesOfRun, spotOf, usualSide } from "./spots.js";

/** The icons of tools: strokes in a square of 24 by 24. */
const ICONS = {
  walls: "M4 20V4h8v8h8v8",
  glass: "M6 3h12v18H6zM9.5 11l4-4M9.500 16l6-6",
  door: "M4 21h16M7 21V3h10v18M13.500 12v1",
  small: "M12 7c3 4 4 5.5 4 7.5a4 4 0 0 1-8 0c0-2 1-3.5 4-7.5z",
  large:
    "M9.5 4c4 5.5 5.5 8 5.5 10.5a5.5 5.5 0 0 1-11 0c0-2.5 1.5-5 5.5-10.5zM18 4c1.5 2.200 2.300 3.300 2.300 4.5a2.300 2.300 0 0 1-4.600 0c0-1.200.8-2.300 2.300-4.5z",
  blocked: "M4 4h16v16H4zM4 14L14 4M4 20L20 4M10 20L20 10",
  area: "M4 6V4h2M10 4h4M18 4h2v2M20 10v4M20 18v2h-2M14 20h-4M6 20H4v-2M4 14v-4M9 9h6v6H9z",
  item: "M8 20a4 4 0 1 1 0-8 4 4 0 0 1 0 8zM11 13l9-9M16 8l3 3",
  switch: "M8 7h8a5 5 0 0 1 0 10H8A5 5 0 0 1 8 7zM16 10.5a1.5 1.5 0 1 1 0 3 1.5 1.5 0 0 1 0-3z",
  box: "M4 4h16v16H4zM9 4v16M15 4v16M4 20L20 4",
  target: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M12 10a2 2 0 1 1 0 4 2 2 0 0 1 0-4z",
  erase: "M9 20H20M13.5 4.5l6 6L11 19H7.5L4 15.5a1.400 1.400 0 0 1 0-2zM8.5 9.5l6 6",
  select: "M6 3l12 9.5-5.5.7L16 20l-2.600 1.200-3.300-6.700L6 18z",
  stamp:
    "M5 21h14M5 17h14v-2a2 2 0 0 0-2-2h-3.500c0-3 1.500-4 1.500-6.500a3 3 0 0 0-6 0c0 2.500 1.500 3.500 1.500 6.500H7a2 2 0 0 0-2 2z",
  start: "M6 21V4M6 4h12l-3 4 3 4H6",
  robot: "M6 9h12v8H6zM12 9V5M10 5h4M3 12v3M21 12v3M9 20h6M9.500 12.500v1M14.500 12.500v1",
  exit: "M10 4H5v16h5M9 12h11M16 7.5l4.5 4.5-4.5 4.5",
  warp: "M5 20a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM5 12C5 7 9 5 13 5h6M15.5 1.5L19 5l-3.5 3.5",
  path: "M5 20a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM7 18h6a3 3 0 0 0 0-6h-2a3 3 0 0 1 0-6h8M16 3l3 3-3 3",
  wind: "M3 9h11a3 3 0 1 0-3-3M3 13h15a3 3 0 1 1-3 3M3 17h7",
};

/** The tools in the order of the rail. `key` is the key that chooses it. @type {Omit<Tool, "icon">[]} */
const IN_ORDER = [
  {
    name: "walls",
    key: "1",
    title: "Walls",
    hint: "Click a side of a cell, or drag along sides, to build walls; again to remove them",
    builds: "wall",
    gesture: drawnWalls,
  },
  {
    name: "glass",
    key: "X",
    title: "Glass",
    hint: "Click a side of a cell, or drag along sides",
    builds: "glass",
    gesture: drawnWalls,
  },
  {
    name: "door",
    key: "D",
    title: "Door",
    hint: "Click a side of a cell; an item, a switch or a target opens it",
    builds: "door",
    gesture: drawnWalls,
  },
  { name: "small", key: "2", title: "Small puddle", hint: "Drag over cells", gesture: painted },
  { name: "large", key: "3", title: "Large puddle", hint: "Drag over cells", gesture: painted },
  { name: "blocked", key: "4", title: "Blocked", hint: "Drag over cells", gesture: painted },
  { name: "area", key: "5", title: "Area", hint: "Drag from corner to corner", isRectangle: true, gesture: painted },
  { name: "item", key: "6", title: "Item", hint: "Click a cell", isSingle: true, gesture: painted },
  { name: "switch", key: "7", title: "Switch", hint: "Click a cell", isSingle: true, gesture: painted },
  { name: "box", key: "K", title: "Box", hint: "Click a cell", isSingle: true, gesture: painted },
  {
    name: "target",
    key: "O",
    title: "Target",
    hint: "Click a cell: the place of a box",
    isSingle: true,
    gesture: painted,
  },
  {
    name: "erase",
    key: "8",
    title: "Eraser",
    hint: "Drag over cells or along walls; the right button does the same",
    gesture: erased,
  },
  {
    name: "select",
    key: "9",
    title: "Select and move",
    hint: "Click something to select it, drag it to move it",
    gesture: moved,
  },
  {
    name: "stamp",
    key: "C",
    title: "Copy and stamp",
    hint: "Drag over what to copy; then click where its upper left cell goes",
    gesture: copied,
  },
  {
    name: "start",
    key: "S",
    title: "Start",
    hint: "Click the cell; with Shift, one more",
    isSingle: true,
    isMore: true,
    gesture: painted,
  },
  {
    name: "robot",
    key: "A",
    title: "Robot",
    hint: "Click a cell to add a robot; drag from one to give it an exit of its own",
    gesture: joined,
  },
  {
    name: "exit",
    key: "E",
    title: "Exit",
    hint: "Click the cell; with Shift, one more",
    isSingle: true,
    isMore: true,
    gesture: painted,
  },
  { name: "warp", key: "T", title: "Warp", hint: "Drag from the cell to its target", gesture: warped },
  {
    name: "path",
    key: "G",
    title: "Mover",
    hint: "Drag through the cells that it walks; with Shift, it wanders in a rectangle",
    gesture: walked,
  },
  {
    name: "wind",
    key: "W",
    title: "Wind",
    hint: "Click an arrow at the rim; the right button weakens the wind",
    gesture: () => null,
  },
];

/** @type {Tool[]} */
export const TOOLS = IN_ORDER.map((tool) => ({ ...tool, icon: ICONS[tool.name] }));

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

/** Return those of some cells that are in the level. */
export function insideOf(editor, cells) {
  const [width, height] = sizeOf(editor);
  return cells.filter(([x, y]) => x >= 0 && y >= 0 && x < width && y < height);
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
  const { game } = editor;
  const [width, height] = sizeOf(editor);
  const [x, y] = beyond(cell, side);
  if (x < 0 || y < 0 || x >= width || y >= height) return "wall";
  // From an exit nothing is possible, but from beside it.
  const isOpen = ([column, row], action) => ((game.data.possible[row * width + column] >> action) & 1) === 1;
  const action = "-NESW".indexOf(side);
  return isOpen(cell, action) || isOpen([x, y], ((action + 1) % 4) + 1) ? null : "wall";
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
