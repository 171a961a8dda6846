// The result of an episode: how it ended, what one's own decisions cost, and how lucky it was.

import { formatted, rounded } from "./game.js";
import { decisionsOf } from "./regret.js";

const SHARE_OF_TWO_STARS = 0.1;

/** @param {Game} game */
const isBad = ({ end }) => end === "hit" || end === "over";

/**
 * Return how many of three stars the decisions of an episode earn; null if that is not known, and of
 * one that was watched.
 *
 * @param {Game} game
 * @returns {number | null}
 */
export function starsOf(game) {
  const decisions = game.watched > 0 ? null : decisionsOf(game);
  if (decisions === null) return null;
  const { cost, optimum } = decisions;
  if (cost === 0) return 3;
  if (isBad(game)) return 0;
  const { random } = game.known.returns;
  if (random !== null && cost <= SHARE_OF_TWO_STARS * (optimum - random)) return 2;
  return Number(game.isGood);
}

/** Say how good the decisions of a good episode were; null if that is not known. @param {Game} game */
export function verdictOf(game) {
  if (!game.isGood || starsOf(game) === null) return null;
  const { cost } = decisionsOf(game);
  if (cost === 0) return "Best possible!";
  const { taken, data } = game;
  const [{ reward }] = taken;
  // Where each step costs the same, the cost tells the steps.
  const isEven = (data.discount ?? 1) === 1 && reward < 0 && taken.slice(0, -1).every((step) => step.reward === reward);
  const steps = isEven ? rounded(-cost / reward) : 0;
  if (steps < 1 || !Number.isInteger(steps)) return `${formatted(cost)} more than needed`;
  return `${steps} step${steps > 1 ? "s" : ""} more than needed`;
}

/** Describe how stars are given. @param {Game} game */
export function ruleOf({ known }) {
  const { best, random } = known.returns;
  const most = random === null ? 0 : SHARE_OF_TWO_STARS * (best - random);
  const two = `Two: together they cost at most ${formatted(most)} of the return. `;
  return (
    "Luck does not count, only your decisions. Three stars: each of them was a best one, and cost nothing. " +
    `${random === null ? "" : two}` +
    "One: a good end. None: a bad end that a decision of yours helped to bring about."
  );
}

/** Describe what helped the player; the empty text for nothing. @param {Game} game */
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
  const { total } = game;
  const { cost, luck } = decisionsOf(game) ?? { cost: null, luck: null };
  /** @type {[string, string][]} */
  const facts = [
    ["Return", formatted(total)],
    ["Decisions", cost === null ? "" : `cost ${formatted(cost)}`],
    ["Luck", Number.isFinite(luck) ? `${luck > 0 ? "+" : ""}${formatted(luck)}` : ""],
    ["Help", helpOf(game)],
  ];
  return facts.filter(([, text]) => text !== "");
}
