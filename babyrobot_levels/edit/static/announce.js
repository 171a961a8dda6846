// What is told to people who do not see the picture: what changed, and what is in a cell.
const SIDE_NAMES = { N: "north", E: "east", S: "south", W: "west" };
const STEPS_TO = { N: [0, -1], E: [1, 0], S: [0, 1], W: [-1, 0] };

/** Return a cell as it is written in level files. */
function named([x, y]) {
  return `[${x}, ${y}]`;
}

function isSame(one, other) {
  return one[0] === other[0] && one[1] === other[1];
}

/** Return the cell beside a cell, at a side. */
function beside([x, y], side) {
  const [dx, dy] = STEPS_TO[side];
  return [x + dx, y + dy];
}

/** Return what stands in a cell: the entries of `state.places` that are not at its sides. */
function placesAt(state, cell) {
  return (state.places ?? []).filter(({ cells }) => cells.some((each) => isSame(each, cell)));
}

/** Return what stands at a side of a cell: an entry of `state.places`; undefined for none. */
function placeAtSide(state, cell, side) {
  const opposite = "NESW"["NESW".indexOf(side) ^ 2];
  const ends = [[...cell, side], [...beside(cell, side), opposite]];
  return (state.places ?? []).find(({ kind, sides }) => kind !== "opening" &&
    sides.some((each) => ends.some((end) => end.every((part, at) => part === each[at]))));
}

/** Return what a side of a cell is: "open", "wall", or the label of glass or of a door. */
function sideOf(state, cell, side) {
  const place = placeAtSide(state, cell, side);
  if (place !== undefined && !(place.kind === "wall" && place.label === "wall")) return place.label;
  const { width, possible } = state.level;
  const bits = possible[cell[1] * width + cell[0]];
  return (bits >> (1 + "NESW".indexOf(side))) & 1 ? "open" : "wall";
}

/** Describe a cell: what stands in it, what closes its sides, and what is wrong there. */
function describedCell(state, cell) {
  if (state.level === null) return named(cell);
  const labels = placesAt(state, cell).map(({ label }) => label);
  const closed = Map.groupBy([..."NESW"], (side) => sideOf(state, cell, side));
  closed.delete("open");
  const sides = [...closed].map(([what, where]) =>
    `${what} ${listed(where.map((side) => SIDE_NAMES[side]))}`);
  const isUnreachable = (state.unreachable ?? []).some((each) => isSame(each, cell));
  const findings = (state.findings ?? [])
    .filter(({ cells = [] }) => cells.some((each) => isSame(each, cell)))
    .map(({ severity, message }) => `${severity}: ${message}`);
  const parts = [
    labels.length > 0 ? listed(labels) : "empty",
    ...sides,
    ...(isUnreachable ? ["cannot be reached"] : []),
    ...findings,
  ];
  return `${named(cell)}: ${parts.join("; ")}`;
}

const BRUSH_NAMES = {
  small: "Small puddle", large: "Large puddle", blocked: "Blocked", start: "Start", exit: "Exit",
  area: "Area", item: "Item", switch: "Switch",
};

/** Return the cells of a gesture in words. */
function cellsInWords(cells, isRectangle = false) {
  const [first, last] = [cells[0], cells.at(-1)];
  if (isSame(first, last)) return named(first);
  if (isRectangle) return `the cells from ${named(first)} to ${named(last)}`;
  return `${cells.length} cells, from ${named(first)} to ${named(last)}`;
}

function wallsInWords(state, { at, side, length = 1 }) {
  const end = "NS".includes(side) ? [at[0] + length - 1, at[1]] : [at[0], at[1] + length - 1];
  const place = length === 1 ? `side of ${named(at)}` : `sides of ${named(at)} to ${named(end)}`;
  const what = sideOf(state, at, side);
  return `${capital(what)}: ${SIDE_NAMES[side]} ${place}.`;
}

function capital(words) {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** What a message to Python did, in words, by what it asked for; the state is that after it. */
const TOLD = {
  walls: (gesture, state) => wallsInWords(state, gesture),
  paint: ({ brush, cells, rectangle }) => brush === "erase" ?
    `Erased: ${cellsInWords(cells, rectangle)}.` :
    `${BRUSH_NAMES[brush]} in ${cellsInWords(cells, rectangle)}.`,
  fill: ({ brush, at }) => brush === "erase" ?
    `Erased: what is like ${named(at)} around it.` :
    `${BRUSH_NAMES[brush]} in ${named(at)} and all cells like it around it.`,
  warp: ({ at, to }) => `Warp from ${named(at)} to ${named(to)}.`,
  path: ({ cells }) => `Path through ${cellsInWords(cells)}.`,
  move: ({ from, to }) => `Moved from ${named(from)} to ${named(to)}.`,
  remove: () => "Removed.",
  set: ({ route, value }) => `${route.join(" ")}: ${value === null ? "removed" : JSON.stringify(value)}.`,
  resize: (gesture, { level }) => `The level has ${level.width} columns and ${level.height} rows.`,
  wind: ({ side, index, strength }) => strength === 0 ?
    `No wind in ${"NS".includes(side) ? "column" : "row"} ${index}.` :
    `Wind to the ${SIDE_NAMES[side]} in ${"NS".includes(side) ? "column" : "row"} ${index}: ${strength}.`,
  resolve: () => "The maze is written out as walls.",
  fix: () => "The finding is fixed.",
  undo: () => "Undone.",
  redo: () => "Done again.",
};

/** Tells changes as they are made, and the cell of the cursor as it moves. */
class Announcer {
  constructor(editor, place) {
    this.editor = editor;
    this.place = place;
    editor.on("done", () => {
      const told = TOLD[editor.done.do]?.(editor.done, editor.state);
      if (told !== undefined) editor.say(told);
    });
    editor.on("cursor", () => this.speak(describedCell(editor.state, editor.cursor.cell)));
  }

  /** Have a text read out; what is said twice is another text, or it would not be read again. */
  speak(words) {
    this.place.textContent = this.place.textContent === words ? `${words}\u00a0` : words;
  }
}
