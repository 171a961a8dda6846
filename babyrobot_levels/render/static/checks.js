// Checks of a link's data: only what could be a level is played and painted.

import { COMMON } from "./common.js";

// How many numbers a row of the tables has for each outcome.
export const OUTCOME_LENGTH = 6;
export const MOST_SHAPES = 200000;
export const MOST_PLACES = 6e6; // Numbers in all paths together.
const MOST_OUTCOMES = 2e7; // Numbers in the rows of all states and actions together.
const MOST_THINGS = 1000;
const FARTHEST = 1e8; // In tenths of a pixel.

/** A defect of a link, with a message for people. */
export class LinkError extends Error {}

export const NOT_A_LEVEL = "This link is damaged: its content is not a level.";

/** Throw a LinkError unless a condition holds. @param {boolean} holds @returns {asserts holds} */
export function need(holds) {
  if (!holds) throw new LinkError(NOT_A_LEVEL);
}

/**
 * Return an integer from `least` to `most`.
 *
 * @param {any} value
 * @param {number} [least]
 * @param {number} [most]
 * @returns {number}
 */
export function whole(value, least = -FARTHEST, most = FARTHEST) {
  need(Number.isInteger(value) && value >= least && value <= most);
  return value;
}

/** @param {any} value @param {number} [most] @param {number} [least] @returns {any[]} */
export function list(value, most = Infinity, least = 0) {
  need(Array.isArray(value) && value.length >= least && value.length <= most);
  return value;
}

/** @param {any} value @returns {string} */
export function text(value) {
  need(typeof value === "string");
  return value;
}

/** Return a colour of six or eight hexadecimal digits. @param {any} value @returns {string} */
export function color(value) {
  need(/^#[0-9a-f]{6}(?:[0-9a-f]{2})?$/.test(text(value)));
  return value;
}

/** Return the data of a level that can be played. @param {any} data @returns {LevelData} */
export function checked(data) {
  need(data !== null && typeof data === "object");
  checkTexts(data);
  const cells = whole(data.width, 1, COMMON.max_cells) * whole(data.height, 1, COMMON.max_cells);
  need(cells <= COMMON.max_cells);
  const configurations = checkThings(data, cells);
  const states = cells * configurations;
  const robots = checkRobots(data, configurations);
  // A robot that moves diagonally has nine actions.
  const actions = robots === 1 && data.table?.length === 9 * states ? 9 : 5 ** robots;
  need(states * actions <= 5 * COMMON.max_states);
  for (const state of list(data.starts, 100 * states, 1)) whole(state, 0, states - 1);
  for (const cell of list(data.exits, cells)) whole(cell, 0, cells - 1);
  if (data.max_steps !== null) whole(data.max_steps, 1, Infinity);
  need(data.learn === undefined || typeof data.learn === "boolean");
  need(Number.isFinite(data.margin) && data.margin >= 0 && data.margin <= 1000);
  need(Number.isFinite(data.speed) && data.speed > 0 && data.speed <= 100);
  const movers = (data.things ?? []).filter(({ kind }) => kind === "mover").length;
  const { discount = 1, good_ends: good = [] } = data;
  need(Number.isFinite(discount) && discount > 0 && discount <= 1);
  for (const cell of list(good, cells)) whole(cell, 0, cells - 1);
  checkRows(data.rows, actions * states, COMMON.events.length * (1 + movers));
  checkTable(data, states, actions, 2 ** (robots === 1 ? actions : 5 * robots) - 1);
  checkAdvice(data, states, actions);
  return data;
}

/** Things: what they are called, and what is where; return the number of configurations. */
function checkThings({ things = [], picture }, cells) {
  const configurations = list(things, MOST_THINGS)[0]?.values.length ?? 1;
  const last = list(picture?.looks ?? []).length - 1;
  let shown = 0;
  const checkLooks = (looks) => {
    shown += list(looks, MOST_SHAPES).length;
    looks.forEach((look) => whole(look, 0, last));
  };
  for (const thing of things) {
    const { kind, values, looks, icon } = thing;
    const count = list(looks, MOST_SHAPES, 1).length;
    const checkCells = (lists, least = 0, most = cells) =>
      list(lists, count, count).forEach((found) =>
        list(found, most, least).forEach((cell) => whole(cell, 0, cells - 1)),
      );
    text(thing.name);
    list(values, configurations, configurations).forEach((value) => whole(value, 0, count - 1));
    looks.forEach(checkLooks);
    if (kind === "exit") {
      checkCells(thing.exits);
      list(thing.needs, MOST_THINGS).forEach(text);
    } else if (kind === "door") {
      list(thing.sides, 4 * cells).forEach((number) => whole(number, 0, cells));
    } else if (kind === "box") {
      checkCells(thing.cells, 1, 1);
    } else if (kind === "mover" || kind === "robot") {
      checkCells(thing.cells, 1, 1);
      for (const found of looks) list(found, 1, 1);
      whole(thing.label, -1, last);
    } else {
      need(Object.keys(COMMON.needed).includes(kind));
      checkCells(thing.cells);
      list(icon, 4, 4).forEach((length) => whole(length));
    }
  }
  need(shown <= MOST_SHAPES);
  return configurations;
}

/** Several robots: what they are called, and which have arrived; return how many there are. */
function checkRobots({ robots, things = [] }, configurations) {
  if (robots === undefined) return 1;
  for (const robot of list(robots, 4, 2)) {
    text(robot.name);
    color(robot.color);
    list(robot.arrived, configurations, configurations).forEach((number) => whole(number, 0, 1));
  }
  need(things.filter(({ kind }) => kind === "robot").length === robots.length - 1);
  return robots.length;
}

/** Texts, and lists of texts and colours. */
function checkTexts(data) {
  const { title, description, best, seed, facts, shown, robot } = data;
  const { goal = "", alt = "", rules = [] } = data; // Links of earlier versions have none.
  for (const value of [title, description, best, seed, goal, alt]) text(value);
  need(/^[0-9]{1,40}$/.test(seed));
  need(data.code === undefined || /^brl[0-9]+\.[0-9]+\.[\w-]+$/.test(text(data.code)));
  for (const fact of list(facts, 20)) list(fact, 2, 2).forEach(text);
  // The samples of rules are shapes, which are checked as they are painted.
  for (const [, words, runs] of list(rules, 20).map((rule) => list(rule, 3, 3))) {
    text(words);
    list(runs).forEach((number) => whole(number, 0, COMMON.max_cells));
  }
  for (const name of list(shown, 2)) need(name === "values" || name === "policy");
  list(robot).forEach(color);
  need([2, COMMON.robot.length].includes(robot.length)); // All of them in themes of greys.
}

/** Rows: outcome distributions, whose probabilities add up to 1. */
function checkRows(rows, most, events) {
  for (const row of list(rows, most, 1)) {
    list(row, Infinity, OUTCOME_LENGTH);
    need(row.length % OUTCOME_LENGTH === 0);
    let sum = 0;
    for (let at = 0; at < row.length; at += OUTCOME_LENGTH) {
      const [probability, shift, reward, isOver, event, pose] = row.slice(at, at + OUTCOME_LENGTH);
      need(Number.isFinite(probability) && probability > 0 && probability <= 1);
      need(Number.isFinite(reward));
      whole(shift);
      whole(isOver, 0, 1);
      whole(event, 0, events - 1);
      whole(pose, 0, COMMON.sprites.length - 1);
      sum += probability;
    }
    need(Math.abs(sum - 1) < 1e-6);
  }
}

/** The table: each state and action has a row, and all next states are in the level; `all` are the bits of all actions. */
function checkTable({ rows, table, starts, possible }, states, actions, all) {
  list(table, actions * states, actions * states);
  list(possible, states, states);
  for (const row of table) whole(row, -1, rows.length - 1);
  const isOver = (state) => table[actions * state] === -1;
  need(!starts.some(isOver));
  let outcomes = 0;
  for (let state = 0; state < states; state++) {
    whole(possible[state], isOver(state) ? 0 : 1, all);
    for (let action = 0; action < actions; action++) {
      const number = table[actions * state + action];
      need((number === -1) === isOver(state));
      const row = number === -1 ? [] : rows[number];
      outcomes += row.length;
      need(outcomes <= MOST_OUTCOMES);
      for (let at = 0; at < row.length; at += OUTCOME_LENGTH) {
        const next = whole(state + row[at + 1], 0, states - 1);
        need(row[at + 3] === 1 || !isOver(next));
      }
    }
  }
}

/** Policies, and the marks of values and policies: one number for each state. */
function checkAdvice({ policy, walker, agent, sight, marks, returns, turns, picture }, states, actions) {
  const known = { random: true, best: policy !== null, agent: agent !== undefined, sight: sight !== undefined };
  need(walker === null || known[walker] === true);
  checkNumbers(policy, states, actions - 1);
  checkReturns(returns, states);
  const last = list(picture?.marks ?? []).length - 1;
  whole(picture?.never ?? -1, -1, last);
  for (const name of ["values", "policy"]) checkNumbers(marks?.[name] ?? null, states, last);
  if (turns === undefined) return;
  need(turns !== null && typeof turns === "object" && typeof turns.on === "boolean");
  whole(turns.heading, 0, 3);
  text(turns.best);
  checkReturns(turns.returns, 4 * states);
  checkNumbers(turns.policy, 4 * states, 2);
  checkNumbers(turns.marks?.values ?? null, 4 * states, last);
}

/** The average returns of the optimal policy and of random actions, and the values of all states. */
function checkReturns(returns, states) {
  if (returns === undefined) return;
  need(returns !== null && Number.isFinite(returns.best));
  need(returns.random === null || Number.isFinite(returns.random));
  for (const value of returns.values === undefined ? [] : list(returns.values, states, states)) {
    need(value === null || Number.isFinite(value));
  }
}

function checkNumbers(numbers, count, most) {
  if (numbers === null) return;
  for (const number of list(numbers, count, count)) whole(number, -1, most);
}
