// The simulation: one robot in one level, and what happens in words.

import { OUTCOME_LENGTH } from "./checks.js";
import { COMMON } from "./common.js";
import { Generator } from "./random.js";
import { optimalAction } from "./regret.js";
import { Things } from "./things.js";

/** The directions of moves, by their numbers; most levels have the first four. */
export const SIDES = ["", "north", "east", "south", "west", "north-east", "south-east", "south-west", "north-west"];
export const GOAL = "Move the robot to an exit."; // Of levels that do not say it.
const SWIPE = 28; // Pixels that tell a swipe from a tap.
const FORWARD = 2; // The actions of a robot that turns: 0 left, 1 right, and this.

/** One robot in one level, without a picture. */
export class Game {
  /** @param {LevelData} data @param {boolean} [isTurning] */
  constructor(data, isTurning = false) {
    this.data = data;
    this.cells = data.width * data.height;
    this.things = new Things(data);
    this.isTurning = isTurning;
    /** @type {"optimum" | "agent" | "costs"} What is shown over the cells. */
    this.view = data.agent === undefined ? "optimum" : "agent";
    /** @type {any} What one sees who does not see everything; null on other pages. */
    this.sight = null;
    this.begin(data.seed);
  }

  /** Start the episode of a seed: as text, a whole number. @param {string} seed */
  begin(seed) {
    this.seed = seed;
    this.random = new Generator(seed);
    this.policyRandom = new Generator(seed);
    this.reset();
  }

  /** Start an episode with the next random numbers. */
  reset() {
    const { starts, turns } = this.data;
    this.state = starts[this.random.integer(starts.length)];
    this.heading = this.isTurning ? turns.heading : null;
    this.steps = 0;
    this.total = 0;
    this.end = null;
    this.hitter = null; // The mover that ended the episode.
    this.past = []; // What `undo` goes back to.
    this.taken = []; // The steps of the episode.
    this.undone = 0;
    this.hints = 0;
    this.watched = 0; // How many steps the watched policy took.
    this.isHinted = false;
    this.sight?.begin(this.state);
  }

  /** The seed of the next episode with other random numbers. */
  get nextSeed() {
    return String((BigInt(this.seed) + 1n) % 10n ** 40n);
  }

  /** What is known about the robot as it moves: the whole data, or those of one that turns. @returns {Answers} */
  get known() {
    return this.isTurning ? this.data.turns : this.data;
  }

  /** What is shown over the cells: the optimum, or an agent of a robot that moves, or its costs. */
  get seen() {
    const { agent } = this.data;
    if (agent === undefined || this.isTurning || this.view === "optimum") return this.known;
    return this.view === "agent" ? agent : agent.costs;
  }

  /** The policy that is watched; null for none. */
  get walker() {
    const { walker } = this.data;
    if (walker === "random" || walker === "sight" || (walker === "agent" && this.seen !== this.known)) return walker;
    return this.known.policy === null ? null : walker && "best";
  }

  /** Go back to before the last action; the same action will have the same outcome again. */
  undo() {
    const { place, known, ...before } = this.past.pop();
    this.taken.pop();
    if (this.sight) this.sight.now = known;
    Object.assign(this, before, { end: null, undone: this.undone + 1, isHinted: false });
    this.random.restore(place);
  }

  /** The number of the configuration at hand. */
  get configuration() {
    return this.configurationOf(this.state);
  }

  /** @param {number} state */
  configurationOf(state) {
    return Math.floor(state / this.cells);
  }

  /** The state with the heading, by which the policy and values of a robot that turns are listed. */
  get number() {
    if (!this.isTurning) return this.state;
    return this.state + (3 * this.configuration + this.heading) * this.cells;
  }

  /**
   * Return the marks of values or of optimal actions in all cells.
   *
   * @param {"values" | "policy"} name
   * @param {number} configuration
   * @returns {number[]}
   */
  marks(name, configuration = this.configuration) {
    const { marks } = this.seen;
    const first = (this.isTurning ? 4 * configuration + this.heading : configuration) * this.cells;
    return marks?.[name]?.slice(first, first + this.cells) ?? [];
  }

  /** The action of the level that an action of the robot comes to. @param {number} action @returns {number} */
  moveOf(action) {
    if (!this.isTurning) return action;
    return action === FORWARD ? this.heading + 1 : 0;
  }

  /** @param {number} action */
  isPossible(action) {
    return this.isOpen(this.moveOf(action));
  }

  /** @param {number} move */
  isOpen(move) {
    return ((this.data.possible[this.state] >> move) & 1) === 1;
  }

  /** How many actions a robot that does not turn has: five, or nine where it moves diagonally. */
  get actions() {
    return this.data.table.length / this.data.possible.length;
  }

  /** What may come of an action of the level in a state. */
  outcomesOf(state, action) {
    return this.data.rows[this.data.table[this.actions * state + this.moveOf(action)]];
  }

  /** The colours of the robots, and where they are in a state. */
  get colors() {
    return [this.data.robot[0]];
  }

  /** @param {number} state @returns {Cell[]} */
  places(state) {
    return [this.place(state)];
  }

  /**
   * Take a choice of the player; return the action that comes of it, null if more is to be chosen.
   *
   * @param {number} action
   * @param {number} [_keys]
   * @returns {number | null}
   */
  choose(action, _keys) {
    return action;
  }

  /** What the player is asked for after a step. */
  get turn() {
    return "";
  }

  /** The part of an action that is the player's next choice. */
  partOf(action) {
    return action;
  }

  /**
   * Return where and to which sides arrows show an action; a negative one has none. Staying has no side.
   *
   * @param {number} action
   */
  pointers(action) {
    if (action < 0) return [];
    const { isTurning, heading } = this;
    const turned = action === FORWARD ? heading : (heading + 3 + 2 * action) % 4;
    // North-east is halfway between the sides 0 and 1.
    const side = isTurning ? turned : action > 4 ? action - 4.5 : action - 1;
    return [{ place: this.place(this.state), side }];
  }

  /** Tell where the robot is, in sentences. */
  whereabouts() {
    const facing = this.isTurning ? ` and faces ${SIDES[this.heading + 1]}` : "";
    return [`The robot is at [${this.place(this.state).join(", ")}]${facing}.`];
  }

  /** The pose before the first step. */
  get standing() {
    return this.isTurning ? COMMON.headings[0][this.heading] : 0;
  }

  /** Return the action of the watched policy here; -1 if it has none. @returns {number} */
  advice() {
    if (this.walker === "best") return this.best;
    if (this.walker === "agent") return this.chosen;
    if (this.walker === "sight") return this.sight.advice(this.policyRandom);
    if (this.isTurning) return this.policyRandom.integer(3);
    const possible = [...Array(this.actions).keys()].filter((action) => this.isPossible(action));
    return possible[this.policyRandom.integer(possible.length)];
  }

  /** The action of the optimal policy here; -1 if there is none. @returns {number} */
  get best() {
    return this.end === null ? optimalAction(this) : -1;
  }

  /** The action of the agent here, drawn with its probabilities; -1 if it has none. */
  get chosen() {
    const { choices, policy } = this.data.agent;
    const chances = choices[policy[this.state]] ?? [];
    const draw = this.policyRandom.random();
    let sum = 0;
    return chances.findIndex((chance) => draw < (sum += chance));
  }

  /** Return the action of the optimal policy here, and count that it was asked for. */
  hint() {
    const action = this.walker === "sight" && this.end === null ? this.advice() : this.best;
    if (action >= 0 && !this.isHinted) {
      this.hints += 1;
      this.isHinted = true;
    }
    return action;
  }

  /** Take an action and return the outcome. @param {number} action @returns {Step} */
  step(action) {
    const { state: from, heading, steps, total } = this;
    this.past.push({ state: from, heading, steps, total, place: this.random.place, known: this.sight?.now });
    this.isHinted = false;
    const number = this.number;
    const { max_steps: most } = this.data;
    const move = this.moveOf(action);
    const outcomes = this.outcomesOf(from, action);
    const last = outcomes.length - OUTCOME_LENGTH;
    let at = 0;
    if (last > 0) {
      const draw = this.random.random();
      for (let sum = outcomes[0]; at < last && draw >= sum; sum += outcomes[at]) {
        at += OUTCOME_LENGTH;
      }
    }
    const [, shift, reward, isOver, code, drawn] = outcomes.slice(at, at + OUTCOME_LENGTH);
    const next = from + shift;
    this.taken.push({ number, action, reward });
    this.state = next;
    this.total += reward * (this.data.discount ?? 1) ** steps;
    this.steps += 1;
    if (this.isTurning && action !== FORWARD) this.heading = (this.heading + 3 + 2 * action) % 4;
    // The number of an event also tells which mover hits the robot.
    const { cheer, headings } = COMMON;
    const { event, hit } = this.eventOf(code);
    if (isOver) this.end = this.endOf(next, reward, hit);
    else if (this.steps === most) this.end = "time";
    if (!isOver) this.sight?.step(action, next);
    const pose = this.isTurning ? headings[Number(event === "skid")][this.heading] : drawn;
    const after = this.isGood ? cheer : pose;
    return { from, action, move, next, reward, event, hit, pose, after };
  }

  /** Return what the number of an event means: the event, and the mover that hits the robot. */
  eventOf(code) {
    const { events } = COMMON;
    const hit = this.things.of("mover")[Math.floor(code / events.length) - 1] ?? null;
    return { event: events[code % events.length], hit };
  }

  /**
   * How the last step ended the episode: at an exit or elsewhere, well or badly.
   *
   * @param {number} state
   * @param {number} reward
   * @param {Thing | null} hit
   * @returns {End}
   */
  endOf(state, reward, hit) {
    this.hitter = hit;
    if (hit !== null) return "hit";
    if (this.isExit(state)) return "exit";
    // Old links do not tell which ends are good.
    const isGood = this.data.good_ends?.includes(state % this.cells) ?? reward > 0;
    return isGood ? "good" : "over";
  }

  /** Whether the episode ended well. */
  get isGood() {
    return this.end === "exit" || this.end === "good";
  }

  /** @param {number} state */
  isExit(state) {
    const configuration = this.configurationOf(state);
    return this.things.exitsOf(configuration).includes(state % this.cells) || this.things.isSolved(configuration);
  }

  /** @param {number} state @returns {Cell} */
  place(state) {
    const cell = state % this.cells;
    return [cell % this.data.width, Math.floor(cell / this.data.width)];
  }

  /**
   * Return the upper left corner of a cell in the picture; fractions are between cells.
   *
   * @param {number} x
   * @param {number} y
   * @returns {[number, number]}
   */
  corner(x, y) {
    const [left, top] = [x, y].map((place) => this.data.margin + place * COMMON.cell);
    return [left, top];
  }

  /** Return the squares of cells in the picture as a path; the cells by their places. */
  squares(places, inset = 0) {
    const side = COMMON.cell - 2 * inset;
    const corner = ([x, y]) => this.corner(x, y).map((at) => at + inset);
    return places.map((place) => `M${corner(place).join(" ")}h${side}v${side}h${-side}z`).join("");
  }

  /** Describe the outcome of a step. @param {Step} step */
  describeStep({ from, action, move, next, reward, event, hit }) {
    const place = `[${this.place(next).join(", ")}]`;
    const side = SIDES[move];
    const isSame = from % this.cells === next % this.cells;
    const door = this.things.doorAt(this.configurationOf(from), from % this.cells, move);
    const turned = this.isTurning ? ["Turned left", "Turned right"][action] : undefined;
    const words = {
      stay: turned ?? "Stayed",
      move: `Moved ${side} to ${place}`,
      carried: `Carried to ${place}`,
      bump: `Blocked by ${door ? "the closed door" : "a wall"} to the ${side}`,
      skid: isSame ? `Skidded while moving ${side}, and stayed` : `Skidded to ${place} while moving ${side}`,
      bounce: isSame ? "Bounced off the glass" : `Bounced off the glass to ${place}`,
    };
    const step = `${words[event]}: ${reward > 0 ? "+" : ""}${formatted(reward)}`;
    const [before, after] = [from, next].map((state) => this.configurationOf(state));
    const changes = this.things.changes(before, after);
    // What ended the episode is told by `describeEnd`.
    return [step, ...(hit === null || this.end === "hit" ? [] : [`Hit by the ${hit.name}`]), ...changes].join(". ");
  }

  /** Describe an action as a piece of advice. @param {number} action */
  describeHint(action) {
    const turns = ["turn left", "turn right", "move forward"];
    return `Hint: ${this.isTurning ? turns[action] : action ? `move ${SIDES[action]}` : "stay"}.`;
  }

  /** What ended the episode. */
  get cause() {
    const exit = this.things.isSolved(this.configurationOf(this.state)) ? "All targets covered" : "Exit reached";
    const ways = { exit, hit: `Hit by the ${this.hitter?.name}`, time: "Time limit reached" };
    const cell = this.state % this.cells;
    const isThere = ([, text, runs]) =>
      text.includes("ends the episode") &&
      runs.some((first, at) => at % 2 === 0 && cell >= first && cell < first + runs[at + 1]);
    const name = this.data.rules?.find(isThere)?.[1].split(":")[0] ?? "Ended";
    return ways[this.end] ?? `${capital(name)} at [${this.place(cell).join(", ")}]`;
  }

  /**
   * Return the action towards a cell along a shortest way on which nothing else happens; -1 if there
   * is none. Where movers come and go, the way may be closed later.
   *
   * @param {number} goal
   */
  towards(goal) {
    const here = this.state % this.cells;
    const { width } = this.data;
    const steps = [0, -width, 1, width, -1, 1 - width, width + 1, width - 1, -width - 1].slice(0, this.actions);
    /** @type {Map<number, number>} The first action of the way to each cell. */
    const first = new Map([[here, -1]]);
    for (const cell of first.keys()) {
      for (let action = 1; action < steps.length; action++) {
        const next = cell + steps[action];
        if (!first.has(next) && this.leads(cell, action, next, next === goal))
          first.set(next, cell === here ? action : first.get(cell));
      }
    }
    return first.has(goal) && goal !== here ? this.turnedTo(first.get(goal)) : -1;
  }

  /** Whether an action leads from a cell to its neighbour, and nothing else happens but at the goal. */
  leads(cell, action, next, isGoal) {
    const { cells, data, configuration } = this;
    const isMoving = this.things.of("mover").length > 0;
    // Where movers are now, a cell may be out of reach.
    const isFar = isMoving && cell !== this.state % cells;
    const all = isFar ? [...Array(data.possible.length / cells).keys()] : [configuration];
    return all.some((number) => {
      const state = number * cells + cell;
      const isPossible = ((data.possible[state] >> action) & 1) === 1;
      const outcomes = isPossible ? data.rows[data.table[this.actions * state + action]] : [];
      for (let at = 0; at < outcomes.length; at += OUTCOME_LENGTH) {
        const [, shift, , isOver, code] = outcomes.slice(at, at + OUTCOME_LENGTH);
        const isFree = !isOver && (isMoving || this.configurationOf(state + shift) === configuration);
        if ((state + shift) % cells === next && (isFree || isGoal) && this.eventOf(code).hit === null) return true;
      }
      return false;
    });
  }

  /** Return what a robot does to move to a side: one that turns may have to turn first. */
  turnedTo(side) {
    if (!this.isTurning) return side;
    const turn = (side + 3 - this.heading) % 4;
    return turn === 0 ? FORWARD : Number(turn !== 3);
  }

  /** Describe how the episode ended. */
  describeEnd() {
    const after = `after ${this.steps} step${this.steps === 1 ? "" : "s"}`;
    return `${this.cause} ${after}${this.isGood ? "!" : "."} Return ${formatted(this.total)}.`;
  }
}

/** Return a number with two decimals, or two digits where it is small. @param {number} number */
export function rounded(number) {
  const size = Math.abs(number);
  if (size >= 0.1) return Math.round(number * 100) / 100;
  return size < 1e-6 ? 0 : Number(number.toPrecision(2));
}

/** Return a rounded number as text, with a minus sign. @param {number} number */
export function formatted(number) {
  return String(rounded(number)).replace("-", "\u2212");
}

/** @param {string} words */
export function capital(words) {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Return the number of the side to which a pointer swiped, 0 for a tap. @param {number} dx @param {number} dy */
export function swiped(dx, dy) {
  if (Math.max(Math.abs(dx), Math.abs(dy)) < SWIPE) return 0;
  if (Math.abs(dx) > Math.abs(dy)) return dx > 0 ? 2 : 4;
  return dy > 0 ? 3 : 1;
}
