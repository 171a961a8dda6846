// A sight: which cells are seen, what may be, and what the best agent does who sees no more.

import { OUTCOME_LENGTH } from "./checks.js";

const NEARLY_ONE = 1 - 1e-9;

/** What one with a sight knows who was told the level's rules, and remembers all that was shown. */
export class Sight {
  /** @param {LevelData} data */
  constructor(data) {
    this.data = data;
    this.cells = data.width * data.height;
    this.known = data.sight;
  }

  /** Begin an episode. @param {number} state */
  begin(state) {
    const starts = this.data.starts.map((start) => [start, 1]);
    this.now = { agent: null, seen: new Set(), before: new Set() };
    this.see(state, starts, this.known.roots ?? []);
  }

  /**
   * Take in what a step shows.
   *
   * @param {number} action
   * @param {number} state The state after it, in which the episode goes on.
   */
  step(action, state) {
    const { node } = this.now;
    this.see(state, this.after(action), node === null ? [] : (this.known.nodes[node][1 + action] ?? []));
  }

  /** Take in what a state shows, after some states that may be, and with pairs of nodes ahead. */
  see(state, states, ahead) {
    const { agent, seen, before } = this.now;
    const node = nodeAfter(ahead, this.known.shown[state]);
    const [first] = node === null ? [0] : this.known.nodes[node];
    this.now = {
      belief: this.among(states, state),
      node,
      // Beyond what was explored, it goes on without memory.
      agent: agent ?? (first < 0 ? -1 - first : null),
      seen: this.around(state),
      before: new Set([...before, ...seen]),
    };
  }

  /** Return the cells that are seen around the robot. */
  around(state) {
    const { field, fields } = this.known;
    const [x, y] = [state % this.data.width, Math.floor((state % this.cells) / this.data.width)];
    const seen = new Set(fields === undefined ? Array(this.cells).keys() : []);
    const steps = fields?.[field[state]] ?? [];
    for (let at = 0; at < steps.length; at += 2) {
      const [across, down] = [x + steps[at], y + steps[at + 1]];
      const isInside = across >= 0 && across < this.data.width && down >= 0 && down < this.data.height;
      if (isInside) seen.add(down * this.data.width + across);
    }
    return seen;
  }

  /** Yield the states after an action in those that may be, and the chance of each. */
  *after(action) {
    const { rows, table, possible } = this.data;
    const actions = table.length / possible.length;
    for (const [state, chance] of this.now.belief) {
      const row = rows[table[actions * state + action]];
      for (let at = 0; at < row.length; at += OUTCOME_LENGTH) {
        if (row[at + 3] === 0) yield [state + row[at + 1], chance * row[at]];
      }
    }
  }

  /**
   * Return the probability of each state that looks like a given one.
   *
   * @param {Iterable<number[]>} states
   * @param {number} state
   * @returns {Map<number, number>}
   */
  among(states, state) {
    const { shown } = this.known;
    const found = new Map();
    let sum = 0;
    for (const [each, chance] of states) {
      if (shown[each] !== shown[state]) continue;
      found.set(each, (found.get(each) ?? 0) + chance);
      sum += chance;
    }
    for (const [each, chance] of found) found.set(each, chance / sum);
    return found;
  }

  /**
   * Return where what is not certain may be: its name, a cell, and the probability that it is there.
   *
   * @param {{ all: Thing[] }} things
   * @returns {[string, number, number][]}
   */
  places(things) {
    /** @type {Map<string, number>} By name and cell. */
    const found = new Map();
    for (const [state, chance] of this.now.belief) {
      const configuration = Math.floor(state / this.cells);
      const all = things.all.map(({ name, values, cells, exits }) => [name, (cells ?? exits)?.[values[configuration]]]);
      for (const [name, cells = []] of [["robot", [state % this.cells]], ...all]) {
        for (const cell of cells) {
          const key = `${cell} ${name}`;
          found.set(key, (found.get(key) ?? 0) + chance);
        }
      }
    }
    const places = [...found].filter(([, chance]) => chance < NEARLY_ONE);
    return places.map(([key, chance]) => [key.replace(/^\d+ /, ""), Number.parseInt(key, 10), chance]);
  }

  /** How sure one can be, in words. */
  get told() {
    const chances = [...this.now.belief.values()];
    if (chances.length === 1) return "You can know how everything stands.";
    const most = Math.max(...chances);
    return `What you saw leaves ${chances.length} possibilities; you can be ${inPercent(most)} sure of the likeliest.`;
  }

  /** Return the action of the best agent; -1 where it has none. @param {{ random: () => number }} random */
  advice(random) {
    const { nodes, agents } = this.known;
    const { node, agent, belief } = this.now;
    if (agent === null) return node === null ? -1 : nodes[node][0];
    const [state] = belief.keys();
    const draw = random.random();
    let sum = 0;
    return agents[agent][this.known.shown[state]].findIndex((chance) => draw < (sum += chance));
  }
}

/** Return a probability that is neither 0 nor 1 in percent. @param {number} chance */
export function inPercent(chance) {
  if (chance > 0.995) return "over 99 %";
  return chance < 0.005 ? "under 1 %" : `${Math.round(100 * chance)} %`;
}

/** Return what follows after something shown in a list of pairs; null for nothing. */
function nodeAfter(pairs, shown) {
  for (let at = 0; at < pairs.length; at += 2) if (pairs[at] === shown) return pairs[at + 1];
  return null;
}
