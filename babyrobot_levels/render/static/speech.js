// What is told to people who do not see the picture.

import { SIDES } from "./game.js";
import { listed } from "./things.js";

const MOST_EXITS = 3;

/** Return which sides of the robot's cell are closed. @param {Game} game */
export function closedSides(game) {
  const sides = [...Array(game.actions).keys()].filter((move) => !game.isOpen(move));
  if (sides.length === 0) return "No side is closed.";
  return `Closed: ${listed(sides.map((side) => SIDES[side]))}.`;
}

/** Return where the robot is, what is around it, and where the exits lie. @param {Game} game */
export function surroundings(game) {
  const { width, height } = game.data;
  const [[x, y]] = game.places(game.state);
  const exits = game.things
    .exitsOf(game.configuration)
    .map((exit) => game.place(exit))
    .map(([left, top]) => [left - x, top - y])
    .sort(([a, b], [c, d]) => Math.abs(a) + Math.abs(b) - Math.abs(c) - Math.abs(d));
  const name = exits.length === 1 ? "The exit" : "An exit";
  return [
    ...game.whereabouts(),
    closedSides(game),
    ...exits.slice(0, MOST_EXITS).map(([dx, dy]) => `${name} is ${direction(dx, dy)}.`),
    `The level has ${width} columns and ${height} rows.`,
  ].join(" ");
}

/** Return a distance in words. @param {number} dx @param {number} dy */
function direction(dx, dy) {
  /** @type {[number, string, string][]} */
  const distances = [
    [Math.abs(dx), "column", dx > 0 ? "east" : "west"],
    [Math.abs(dy), "row", dy > 0 ? "south" : "north"],
  ];
  const parts = distances
    .filter(([count]) => count > 0)
    .map(([count, line, side]) => `${count} ${line}${count > 1 ? "s" : ""} ${side}`);
  return parts.length === 0 ? "here" : listed(parts);
}
