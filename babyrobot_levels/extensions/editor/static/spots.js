// Spots: where a pointer or the cursor is in the grid. A spot has `at`, a point in cells; `cell`,
// the cell there, or null outside; `side`, the side of the cell that is near enough to be meant, or
// null; and `rim`, the side beyond which it is, or null.

export const SIDE_NAMES = { N: "north", E: "east", S: "south", W: "west" };
/** @type {Record<Side, [number, number]>} */
const SIDE_SHIFTS = { N: [0, -1], E: [1, 0], S: [0, 1], W: [-1, 0] };
export const REACH = 0.22; // How far from a side, in cells, a mouse means it;
export const FINGER_REACH = 0.32; // and a finger.

/**
 * Return the spot at a point of the grid.
 *
 * @param {[number, number]} at
 * @param {[number, number]} size
 * @param {number} [reach]
 * @returns {Spot}
 */
export function spotAt([x, y], [width, height], reach = REACH) {
  /** @type {Cell} */
  const cell = [Math.floor(x), Math.floor(y)];
  const isInside = x >= 0 && y >= 0 && x < width && y < height;
  const [dx, dy] = [x - cell[0], y - cell[1]];
  /** @type {Record<string, number>} */
  const distances = { N: dy, E: 1 - dx, S: 1 - dy, W: dx };
  const nearest = /** @type {Side} */ (
    Object.keys(distances).reduce((best, side) => (distances[side] < distances[best] ? side : best))
  );
  const beyond = { N: -y, E: x - width, S: y - height, W: -x };
  const outermost = /** @type {Side} */ (
    Object.keys(beyond).reduce((best, side) => (beyond[side] > beyond[best] ? side : best))
  );
  return {
    at: [x, y],
    cell: isInside ? cell : null,
    side: isInside && distances[nearest] <= reach ? nearest : null,
    rim: isInside ? null : outermost,
  };
}

/** Return the spot of a cell, or of one of its sides. @param {Cell} cell @param {Side | null} [side] @returns {Spot} */
export function spotOf([x, y], side = null) {
  const [dx, dy] = SIDE_SHIFTS[side] ?? [0, 0];
  return { at: [x + 0.5 + dx / 2, y + 0.5 + dy / 2], cell: [x, y], side, rim: null };
}

/** Return the cell beyond a side of a cell. @param {Cell} cell @param {Side} side @returns {Cell} */
export function beyond([x, y], side) {
  return [x + SIDE_SHIFTS[side][0], y + SIDE_SHIFTS[side][1]];
}

/** @param {Cell} one @param {Cell} other */
export function isSameCell(one, other) {
  return one[0] === other[0] && one[1] === other[1];
}

/**
 * Return the first and the last cell of the smallest rectangle that has some cells.
 *
 * @param {Cell[]} cells
 * @returns {[Cell, Cell]}
 */
export function cornersOf(cells) {
  const [xs, ys] = [0, 1].map((axis) => cells.map((cell) => cell[axis]));
  return [
    [Math.min(...xs), Math.min(...ys)],
    [Math.max(...xs), Math.max(...ys)],
  ];
}

/**
 * Return a side as level files prefer it: of the cell to the north or west, where there is one.
 *
 * @param {Cell} cell
 * @param {Side} side
 * @returns {[Cell, Side]}
 */
export function usualSide([x, y], side) {
  if (side === "N" && y > 0) return [[x, y - 1], "S"];
  if (side === "W" && x > 0) return [[x - 1, y], "E"];
  return [[x, y], side];
}

/**
 * Return the cells that lines between spots pass through, each once, in their order.
 *
 * @param {Spot[]} spots
 * @returns {Cell[]}
 */
export function cellsAlong(spots) {
  const cells = new Map();
  const last = spots.reduce((from, spot) => {
    const [dx, dy] = [spot.at[0] - from.at[0], spot.at[1] - from.at[1]];
    const steps = Math.ceil(4 * Math.max(Math.abs(dx), Math.abs(dy), 0.25));
    for (let step = from === spot ? steps : 0; step <= steps; step++) {
      const cell = [from.at[0] + (step * dx) / steps, from.at[1] + (step * dy) / steps].map(Math.floor);
      cells.set(cell.join(), cell);
    }
    return spot;
  }, spots[0]);
  return last === undefined ? [] : [...cells.values()];
}

/**
 * Return the straight run of sides from the first spot to the last, as the gesture `walls` has it.
 *
 * It lies along the side of the first spot; at a corner, along the way that was dragged.
 *
 * @param {Spot[]} spots
 * @param {[number, number]} size
 * @returns {Run}
 */
export function runAlong(spots, [width, height]) {
  const [first, last] = [spots[0], spots.at(-1)];
  const shift = first.at.map((place, axis) => Math.abs(last.at[axis] - place));
  const isAtCorner = first.at.every((place) => Math.abs(place - Math.round(place)) <= FINGER_REACH);
  const isDragged = Math.max(...shift) > 0.4;
  const isHorizontal = isAtCorner && isDragged ? shift[0] > shift[1] : "NS".includes(first.side);
  const [along, across] = isHorizontal ? [0, 1] : [1, 0];
  const most = [width, height][along] - 1;
  const ends = [first, last].map(({ at }) => Math.min(most, Math.max(0, Math.floor(at[along]))));
  const line = Math.round(first.at[across]);
  /** @type {any} */
  const at = [];
  at[along] = Math.min(...ends);
  at[across] = Math.max(0, line - 1);
  const side = isHorizontal ? (line === 0 ? "N" : "S") : line === 0 ? "W" : "E";
  return { at, side, length: Math.abs(ends[1] - ends[0]) + 1 };
}

/** Return the sides of a run, each as a cell and its side. @param {Run} run @returns {[Cell, Side][]} */
export function sidesOfRun({ at: [x, y], side, length = 1 }) {
  const isHorizontal = "NS".includes(side);
  return Array.from({ length }, (_, step) => [[x + (isHorizontal ? step : 0), y + (isHorizontal ? 0 : step)], side]);
}
