// Several robots in one level: who moves which, and what a step does to each.

import { COMMON } from "./common.js";
import { html } from "./dom.js";
import { capital, formatted, Game, SIDES } from "./game.js";

/** The game of a level. */
export function gameOf(data) {
  return data.robots === undefined ? new Game(data, data.turns?.on ?? false) : new TeamGame(data);
}

/** Several robots in one level, without a picture. All move at once: an action is one of each, as a number. */
class TeamGame extends Game {
  /** @param {LevelData} data */
  constructor(data) {
    super(data);
    this.robots = data.robots;
    this.mates = this.things.of("robot");
    /** The robots that the player moves; the optimum moves the others. */
    this.hands = this.robots.map((_, robot) => robot);
  }

  reset() {
    super.reset();
    this.picked = []; // The actions that are chosen for the next step, by robot.
  }

  undo() {
    super.undo();
    this.picked = [];
  }

  get colors() {
    return this.robots.map(({ color }) => color);
  }

  places(state) {
    return this.robots.map((_, robot) => this.place(this.cellOf(robot, state)));
  }

  /** The cell in which a robot is, or was when it left. */
  cellOf(robot, state = this.state) {
    if (robot === 0) return state % this.cells;
    const { cells, values } = this.mates[robot - 1];
    return cells[values[this.configurationOf(state)]][0];
  }

  hasArrived(robot, state = this.state) {
    return this.robots[robot].arrived[this.configurationOf(state)] === 1;
  }

  /** The robots whose actions the player has to choose before the next step. */
  get waiting() {
    return this.hands.filter((robot) => !(robot in this.picked) && !this.hasArrived(robot));
  }

  /** The robot that is asked for its action. */
  get asked() {
    return this.waiting[0] ?? this.hands[0];
  }

  get turn() {
    return this.hands.length > 1 && this.waiting.length > 0 ? `${capital(this.robots[this.asked].name)}?` : "";
  }

  partOf(action) {
    return action < 0 ? action : this.partsOf(action)[this.asked];
  }

  /**
   * Choose an action; once the player chose for all that wait, return that of all robots, else null.
   *
   * @param {number} action
   * @param {number} [keys] Which of two sets of keys it was: each has a robot if the player moves two.
   */
  choose(action, keys) {
    const own = this.hands.length === 2 ? this.hands[keys] : undefined;
    this.picked[own === undefined || this.hasArrived(own) ? this.asked : own] = action;
    if (this.waiting.length > 0) return null;
    const best = this.partsOf(Math.max(this.best, 0));
    return this.joint(best.map((part, robot) => (this.hands.includes(robot) ? (this.picked[robot] ?? 0) : part)));
  }

  /** @param {number} action */
  partsOf(action) {
    return this.robots.map((_, robot) => Math.floor(action / 5 ** (this.robots.length - 1 - robot)) % 5);
  }

  /** @param {number[]} parts */
  joint(parts) {
    return parts.reduce((number, part) => 5 * number + part, 0);
  }

  moveOf(action) {
    return this.partsOf(action)[0];
  }

  get actions() {
    return 5;
  }

  outcomesOf(state, action) {
    return this.data.rows[this.data.table[5 ** this.robots.length * state + action]];
  }

  /** Whether the robot that is asked can take an action. */
  isPossible(action) {
    return this.isOpen(action);
  }

  isOpen(move, robot = this.asked) {
    return ((this.data.possible[this.state] >> (5 * robot + move)) & 1) === 1;
  }

  get standing() {
    return this.hasArrived(0) ? COMMON.cheer : 0;
  }

  advice() {
    if (this.walker === "best") return this.best;
    const open = (robot) => [0, 1, 2, 3, 4].filter((move) => this.isOpen(move, robot));
    const choices = this.robots.map((_, robot) => open(robot));
    return this.joint(choices.map((moves) => moves[this.policyRandom.integer(moves.length)]));
  }

  pointers(action) {
    const parts = action < 0 ? this.picked : this.partsOf(action);
    return this.places(this.state).flatMap((place, robot) =>
      parts[robot] === undefined || this.hasArrived(robot) ? [] : [{ place, side: parts[robot] - 1 }],
    );
  }

  step(action) {
    this.picked = [];
    const found = super.step(action);
    return this.hasArrived(0) ? { ...found, after: COMMON.cheer } : found;
  }

  endOf(state, reward, hit) {
    this.hitter = hit;
    if (hit !== null) return "hit";
    const arrived = this.robots.filter((_, robot) => this.hasArrived(robot, state)).length;
    const isDone = arrived === this.robots.length || (this.data.ends_first && arrived > 0);
    return isDone || this.things.isSolved(this.configurationOf(state)) ? "exit" : "over";
  }

  get cause() {
    if (this.end === "over") return "The episode ended";
    if (this.end !== "exit" || this.things.isSolved(this.configuration)) return super.cause;
    const arrived = this.robots.filter((_, robot) => this.hasArrived(robot)).map(({ name }) => capital(name));
    return arrived.length === this.robots.length ? "All have arrived" : `${arrived.join(", ")} arrived`;
  }

  /** A step to a neighbouring cell by the robot that is asked. */
  towards(goal) {
    const here = this.cellOf(this.asked);
    const { width } = this.data;
    const move = [0, here - width, here + 1, here + width, here - 1].indexOf(goal, 1);
    return move > 0 && this.isOpen(move) ? move : -1;
  }

  describeStep({ from, action, next, reward, hit }) {
    const parts = this.partsOf(action);
    const told = this.robots.flatMap(({ name }, robot) => {
      if (this.hasArrived(robot, from)) return [];
      const [before, after] = [from, next].map((state) => this.cellOf(robot, state));
      const home = this.hasArrived(robot, next) ? " and has arrived" : "";
      return [`${capital(name)} ${this.wayOf(before, after, parts[robot])}${home}`];
    });
    const changes = this.things.changes(this.configurationOf(from), this.configurationOf(next));
    const blow = hit === null || this.end === "hit" ? [] : [`Hit by the ${hit.name}`];
    return [`${told.join(", ")}: ${reward > 0 ? "+" : ""}${formatted(reward)}`, ...blow, ...changes].join(". ");
  }

  /** What an action did to a robot, in words. */
  wayOf(before, after, part) {
    const shift = [0, -this.data.width, 1, this.data.width, -1][part];
    if (before === after) return part === 0 ? "stayed" : `could not move ${SIDES[part]}`;
    if (after - before === shift) return `moved ${SIDES[part]}`;
    return `came to [${this.place(after).join(", ")}]`;
  }

  describeHint(action) {
    const parts = this.partsOf(action);
    const told = this.robots
      .map(({ name }, robot) => `${name} ${parts[robot] ? `moves ${SIDES[parts[robot]]}` : "stays"}`)
      .filter((_, robot) => !this.hasArrived(robot));
    return `Hint: ${told.join(", ")}.`;
  }

  whereabouts() {
    const told = (robot) => (this.hasArrived(robot) ? "has arrived" : "is");
    return this.places(this.state).map(
      (place, robot) => `${capital(this.robots[robot].name)} ${told(robot)} at [${place.join(", ")}].`,
    );
  }
}

/** The choice of which robots the player moves. */
export class Hands {
  /** @param {HTMLElement} place @param {() => void} changed */
  constructor(place, changed) {
    this.place = place;
    place.addEventListener("change", ({ target }) => {
      /** @type {any[]} */
      const boxes = [...place.querySelectorAll("input")];
      // Somebody has to be moved.
      if (!boxes.some(({ checked }) => checked)) /** @type {any} */ (target).checked = true;
      this.game.hands = boxes.flatMap(({ checked }, robot) => (checked ? [robot] : []));
      this.game.picked = [];
      changed();
    });
  }

  begin(game) {
    this.game = game;
    const { robots, known } = game;
    this.place.hidden = robots === undefined || known.policy === null;
    if (robots === undefined) return;
    const chips = robots.map(({ name, color }) => {
      const dot = html("i", {});
      dot.style.background = color;
      return html("label", {}, html("input", { type: "checkbox", checked: true }), dot, name);
    });
    this.place.replaceChildren(this.place.firstElementChild, ...chips, this.place.lastElementChild);
  }
}
