// What the decisions of an episode cost: by the optimal values of all actions, for each number of
// steps that are left. `analysis/solver/by_step.py` computes the same numbers.

import { OUTCOME_LENGTH } from "./checks.js";

const MOST_WORK = 1e8; // Over all steps after which values still change: about a second.
const LEAST_WORK = 1000; // As how many outcomes a round counts, however few there are.
const MOST_VALUES = 5e6;
const EQUAL = 1e-9; // Actions are equally good if their values differ by no more than this share.

/** The optimal values of the states that an episode can reach. */
class Values {
  /** @param {Game} game */
  constructor({ data, isTurning, cells, known }) {
    const { max_steps: limit, starts, discount = 1, rows, table, possible, turns } = data;
    this.discount = discount;
    const stride = table.length / possible.length;
    this.actions = isTurning ? 3 : stride;
    this.places = new Map(); // Of states, by their numbers.
    /** The outcomes of all places and actions: where each begins, and where, how likely, for what it leads. */
    this.ends = [0];
    this.targets = [];
    this.chances = [];
    this.gains = [];
    const numberOf = (state, heading) => state + (isTurning ? 3 * Math.floor(state / cells) + heading : 0) * cells;
    const begins = starts.map((state) => this.placeOf(numberOf(state, turns?.heading ?? 0)));
    for (const number of this.places.keys()) {
      const block = Math.floor(number / cells);
      const heading = isTurning ? block % 4 : 0;
      const state = isTurning ? Math.floor(block / 4) * cells + (number % cells) : number;
      for (let action = 0; action < this.actions; action++) {
        const isTurn = isTurning && action < 2;
        const row = rows[table[stride * state + (isTurn ? 0 : isTurning ? heading + 1 : action)]];
        const after = isTurn ? (heading + 3 + 2 * action) % 4 : heading;
        for (let at = 0; at < row.length; at += OUTCOME_LENGTH) {
          this.chances.push(row[at]);
          this.gains.push(row[at + 2]);
          this.targets.push(row[at + 3] ? -1 : this.placeOf(numberOf(state + row[at + 1], after)));
        }
        this.ends.push(this.targets.length);
      }
    }
    const first = new Float64Array(this.places.size);
    if (limit === null)
      for (const [number, place] of this.places) first[place] = known.returns.values[number] ?? -Infinity;
    this.byLeft = [first];
    while (limit !== null && this.byLeft.length <= limit) {
      const before = this.byLeft.at(-1);
      const best = before.map((_, place) => Math.max(...this.worths(place, before)));
      if (best.every((value, place) => value === before[place])) break;
      const rounds = this.byLeft.push(best);
      if (rounds * (this.targets.length + LEAST_WORK) > MOST_WORK || rounds * best.length > MOST_VALUES)
        throw new RangeError();
    }
    this.optimum = begins.reduce((sum, place) => sum + this.at(limit ?? 0)[place], 0) / begins.length;
  }

  /** @param {number} number */
  placeOf(number) {
    if (!this.places.has(number)) this.places.set(number, this.places.size);
    return this.places.get(number);
  }

  /** The values with a number of steps left. */
  at(left) {
    return this.byLeft[Math.min(left, this.byLeft.length - 1)];
  }

  /** The values of the actions in a place, by those of the places that they lead to. */
  worths(place, ahead) {
    const worths = [];
    for (let row = place * this.actions; worths.length < this.actions; row++) {
      let sum = 0;
      for (let at = this.ends[row]; at < this.ends[row + 1]; at++) {
        const next = this.targets[at];
        sum += this.chances[at] * (this.gains[at] + (next < 0 ? 0 : this.discount * ahead[next]));
      }
      worths.push(sum);
    }
    return worths;
  }

  /** What each action loses in a state: 0 for the best ones. */
  losses(number, left) {
    const worths = this.worths(this.places.get(number), this.at(Math.max(left - 1, 0)));
    const best = Math.max(...worths);
    const least = EQUAL * Math.max(...worths.filter(Number.isFinite).map(Math.abs));
    // Where all is lost, nothing more can be.
    return worths.map((worth) => (best === -Infinity || best - worth <= least ? 0 : best - worth));
  }
}

const KNOWN = new WeakMap();

/** Return the values of a game; null where they are not known, or take too long. @param {Game} game */
function valuesOf(game) {
  const { data, known } = game;
  if (known.returns === undefined || (data.max_steps === null && known.returns.values === undefined)) return null;
  if (!KNOWN.has(known)) {
    try {
      KNOWN.set(known, new Values(game));
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      KNOWN.set(known, null);
    }
  }
  return KNOWN.get(known);
}

/** @param {Game} game */
const leftOf = ({ data, steps }) => (data.max_steps ?? 0) - steps;

/**
 * Return the optimal action here, that of the policy if it is one; with few steps left it may not be.
 *
 * @param {Game} game
 * @returns {number}
 */
export function optimalAction(game) {
  const planned = game.known.policy?.[game.number] ?? -1;
  if (planned < 0 || game.data.max_steps === null) return planned;
  const losses = valuesOf(game)?.losses(game.number, leftOf(game));
  return losses === undefined || losses[planned] === 0 ? planned : losses.indexOf(0);
}

/**
 * Return what the decisions of an episode that has ended cost, and what chance added: together, the
 * return less the optimum. Null where they are not known.
 *
 * @param {Game} game
 * @returns {{ cost: number, luck: number, optimum: number } | null}
 */
export function decisionsOf(game) {
  const values = valuesOf(game);
  if (values === null) return null;
  const { taken, total, data } = game;
  const costs = taken.map(({ number, action }, step) => {
    const lost = values.losses(number, (data.max_steps ?? 0) - step)[action];
    return (data.discount ?? 1) ** step * lost;
  });
  const cost = costs.reduce((sum, each) => sum + each, 0);
  return { cost, luck: total - values.optimum + cost, optimum: values.optimum };
}
