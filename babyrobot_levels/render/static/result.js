// The result of an episode: how good it is, and how lucky.

import { formatted, rounded } from "./game.js";

const WAY_TO_TWO_STARS = 0.9;

/**
 * Return how the episode ended, as a title.
 *
 * @param {Game} game
 */
export function titleOf({ end, isGood }) {
  if (end === "time") return "Time limit reached";
  const how = end === "exit" ? "Exit reached" : "Episode ended";
  return isGood ? `${how}!` : how;
}

/**
 * Return how many of three stars an episode earns; null if the level's returns are unknown.
 *
 * @param {Game} game
 * @returns {number | null}
 */
export function starsOf({ known, total, isGood }) {
  if (known.returns === undefined) return null;
  const { best, random } = known.returns;
  if (rounded(total) >= rounded(best)) return 3;
  if (random === null) return Number(isGood);
  if (total >= random + WAY_TO_TWO_STARS * (best - random)) return 2;
  return Number(isGood || total > random);
}

/**
 * Describe how stars are given.
 *
 * @param {Game} game
 */
export function ruleOf({ known }) {
  const { best, random } = known.returns;
  const three = `Three stars: a return of at least the best average (${formatted(best)}).`;
  if (random === null) return `${three} One: a good end.`;
  return (
    `${three} Two: at least ${100 * WAY_TO_TWO_STARS} % of the way there from the average of ` +
    `random actions (${formatted(random)}). One: a good end, or more than that of random actions.`
  );
}

/**
 * Compare a return with the optimal policy's; the empty text if these are unknown.
 *
 * @param {Game} game
 */
function luckOf({ known, total }) {
  const quantiles = known.returns?.quantiles ?? [];
  const [first, last] = [quantiles[0], quantiles.at(-1)];
  if (first === undefined) return "";
  if (first === last) return `none: the optimal policy always has a return of ${formatted(first)}`;
  const margin = 1e-9 + 1e-5 * Math.abs(total);
  const percent = (wanted) => Math.round((100 * quantiles.filter(wanted).length) / quantiles.length);
  const less = percent((other) => other < total - margin);
  const more = percent((other) => other > total + margin);
  /** @type {[string, number][]} */
  const parts = [
    ["better than", less],
    ["equal to", 100 - less - more],
    ["worse than", more],
  ];
  const told = parts.filter(([, share]) => share > 0).map(([how, share]) => `${how} ${share} %`);
  return `${told.join(", ")} of the optimal policy's episodes`;
}

/**
 * Describe what helped the player; the empty text for nothing.
 *
 * @param {Game} game
 */
function helpOf({ hints, undone, watched }) {
  /** @type {(number: number, name: string) => string[]} */
  const count = (number, name) => (number ? [`${number} ${name}${number > 1 ? "s" : ""}`] : []);
  return [...count(hints, "hint"), ...count(undone, "undo"), ...count(watched, "watched step")].join(", ");
}

/**
 * Return what the card of a result tells, as pairs of a name and a text.
 *
 * @param {Game} game
 * @returns {[string, string][]}
 */
export function resultFacts(game) {
  const { known, total, steps } = game;
  /** @type {[string, string][]} */
  const facts = [
    ["Return", formatted(total)],
    ["Best average", known.best],
    ["Steps", String(steps)],
    ["Luck", luckOf(game)],
    ["Help", helpOf(game)],
  ];
  return facts.filter(([, text]) => text !== "");
}
