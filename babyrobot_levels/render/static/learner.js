// Learning, update by update: the algorithms of `babyrobot_levels.extensions.learning`, with the same numbers.

import { OUTCOME_LENGTH } from "./checks.js";
import { COMMON } from "./common.js";
import { SIDES } from "./game.js";
import { Generator } from "./random.js";

const LONGEST = 10000; // Steps of an episode without another limit, and rounds and sweeps that are not seen.
const TOLERANCE = 1e-9; // Actions whose values differ by no more than this share are all greedy.
const CONVERGED = 1e-10; // The largest change of a sweep after which no other follows.
const DENSE = 150; // Neighbours of a state.
const ROUNDING = 1e-14; // The share of a value by which a sweep may still change it.
const UNITS = { value_iteration: "sweep", policy_evaluation: "sweep", policy_iteration: "round" };

/** What an algorithm is told: the arguments in Python, by their names. */
export const USUAL = {
  algorithm: "q_learning",
  actions: "moves",
  discount: 1,
  policy: "random",
  step_size: 0.1,
  epsilon: 0.1,
  initial: 0,
  planning_steps: 0,
  n_steps: 1,
  exploring_starts: false,
  seed: "0",
};

const sum = (numbers) => numbers.reduce((one, other) => one + other, 0);
// From -Infinity, Infinity can still be reached.
const plus = (one, other) => (one === Infinity || other === Infinity ? Infinity : one + other);
const only = (row, chosen) => row.map((_, action) => Number(action === chosen));
const scale = (value) => (Number.isFinite(value) ? Math.max(1, Math.abs(value)) : 1);

/** Return the actions that are best but for rounding. */
function greedy(values) {
  const best = Math.max(...values);
  return [...values.keys()].filter((action) => values[action] >= best - TOLERANCE * scale(best));
}

/** Return the data of a level with the headings of a robot that turns: actions 2 left, 3 right, 4 forward. */
function turned(data) {
  const { width, height, starts, rows, table, possible, turns, things = [] } = data;
  const cells = width * height;
  const numbered = (state, heading) => state + (3 * Math.floor(state / cells) + heading) * cells;
  const made = { rows: [], table: [], possible: [], policy: turns.policy?.map((action) => action + 2) };
  possible.forEach((bits, state) => {
    for (let heading = 0; heading < 4; heading++) {
      const number = numbered(state, heading);
      [0, 0, heading + 1].forEach((move, action) => {
        const row = rows[table[5 * state + move]];
        const after = (heading + [3, 1, 0][action]) % 4;
        const shifted = row?.map((value, at) =>
          at % OUTCOME_LENGTH === 1 ? numbered(state + value, after) - number : value,
        );
        made.table[5 * number + 2 + action] = row ? made.rows.push(shifted) - 1 : -1;
      });
      made.possible[number] = ((bits & 1) * 3 + ((bits >> (heading + 1)) & 1) * 4) << 2;
    }
  });
  // Where it looks is one more value of a configuration.
  const own = things.map((thing) => ({ ...thing, values: thing.values.flatMap((value) => Array(4).fill(value)) }));
  const heading = { kind: "mover", name: "", values: made.possible.map((_, number) => number % 4) };
  made.starts = starts.map((state) => numbered(state, turns.heading));
  return { ...data, ...made, things: [...own, heading] };
}

/** A level to learn: what each action leads to, for a set of actions. */
class Problem {
  constructor(level, { actions, discount }) {
    this.headings = actions === "turns" ? 4 : 1;
    const data = this.headings > 1 ? turned(level) : level;
    this.data = data;
    this.cells = data.width * data.height;
    this.discount = discount;
    this.first = { all: 0, moves: 1, turns: 2 }[actions];
    const stride = data.table.length / data.possible.length;
    this.names =
      this.headings > 1 ? ["left", "right", "forward"] : ["stay", ...SIDES.slice(1)].slice(this.first, stride);
    const rows = data.rows.map((row) =>
      Array.from({ length: row.length / OUTCOME_LENGTH }, (_, at) => {
        const [chance, shift, reward, over, code, pose] = row.slice(OUTCOME_LENGTH * at);
        return { chance, shift, reward, over, code, pose };
      }),
    );
    this.size = data.possible.length;
    this.rows = []; // The outcomes of each action, of states in which an episode goes on.
    for (let state = 0; state < this.size; state++) {
      const numbers = data.table.slice(stride * state + this.first, stride * (state + 1));
      if (numbers[0] !== -1) this.rows[state] = numbers.map((number) => rows[number]);
    }
    this.states = Object.keys(this.rows).map(Number);
    const isReached = new Set(data.starts);
    for (const state of this.states) {
      for (const { shift } of this.rows[state].flat()) if (shift !== 0) isReached.add(state + shift);
    }
    /** The states in which an episode starts, or to which another one leads. */
    this.reached = this.states.filter((state) => isReached.has(state));
  }

  /** Return the state of the level at a state, and the heading; null for a robot that moves. */
  split(state) {
    const at = Math.floor(state / this.cells);
    const configuration = Math.floor(at / this.headings);
    return [state - (at - configuration) * this.cells, this.headings > 1 ? at % 4 : null];
  }

  /** Return the side to which an action leads, 0 for none, and the one to which it turns: -1 left, 1 right. */
  way(action, heading) {
    if (this.headings === 1) return [action + this.first, 0];
    return [heading + 1, [-1, 1, 0][action]];
  }

  /** Return the values of actions by those of states. */
  ahead(values, state) {
    return this.rows[state].map((row) => {
      let [now, later] = [0, 0];
      for (const { chance, shift, reward, over } of row) {
        now += chance * reward;
        if (!over) later = plus(later, chance * values[state + shift]);
      }
      return now + this.discount * later;
    });
  }

  /** Return a policy given by name: the probability of each action, for each state. */
  policy(name) {
    const policy = [];
    for (const state of this.states) {
      const possible = name === "uniform" ? 0 : this.data.possible[state] >> this.first;
      const taken = this.rows[state].map((_, action) => Number(possible === 0 || (possible >> action) & 1));
      policy[state] = taken.map((chance) => chance / sum(taken));
    }
    return policy;
  }

  /**
   * Return the exact values of a policy: one state after the other is taken out of its chain, those with few
   * neighbours first, which keeps the chain sparse.
   */
  valuesOf(policy) {
    const values = new Float64Array(this.size); // At first rewards.
    const end = new Float64Array(this.size); // The probability that nothing follows, as a discount also means.
    const [after, before, waiting, order] = [[], [], [], []];
    const isOut = new Set();
    const join = (state, next, chance) => {
      if (next === state || chance === 0) return;
      after[state].set(next, (after[state].get(next) ?? 0) + chance);
      before[next].add(state);
    };
    let least = 0;
    const degree = (state) => after[state].size + before[state].size;
    const wait = (state) => {
      (waiting[degree(state)] ??= []).push(state);
      least = Math.min(least, degree(state));
    };
    for (const state of this.states) [after[state], before[state]] = [new Map(), new Set()];
    for (const state of this.states) {
      this.rows[state].forEach((row, action) => {
        for (const { chance, shift, reward, over } of row) {
          const share = policy[state][action] * chance;
          values[state] += share * reward;
          end[state] += share * (over ? 1 : 1 - this.discount);
          if (!over) join(state, state + shift, share * this.discount);
        }
      });
    }
    this.states.forEach(wait);
    while (order.length < this.states.length) {
      const state = waiting[least]?.pop();
      if (state === undefined) least += 1;
      if (state === undefined || isOut.has(state) || degree(state) !== least) continue;
      if (least > DENSE) break;
      isOut.add(state);
      order.push(state);
      // Added up, not subtracted from 1, which would lose digits; 0 where the episode goes on for ever.
      const going = sum([end[state], ...after[state].values()]);
      if (going > 0) values[state] /= going;
      else values[state] = Math.abs(values[state]) < TOLERANCE ? 0 : values[state] * Infinity;
      for (const [next, chance] of after[state]) {
        after[state].set(next, chance / going);
        before[next].delete(state);
      }
      for (const prior of before[state]) {
        const chance = after[prior].get(state);
        after[prior].delete(state);
        values[prior] = plus(values[prior], chance * values[state]);
        if (going > 0) end[prior] += (chance * end[state]) / going;
        for (const [next, more] of after[state]) join(prior, next, chance * more);
      }
      for (const other of new Set([...before[state], ...after[state].keys()])) wait(other);
    }
    // What is left is no longer sparse: repeated sweeps are faster there.
    const core = this.states.filter((state) => !isOut.has(state));
    const rewards = values.slice();
    for (let [change, sweep] = [Infinity, 0]; change > ROUNDING && sweep < LONGEST; sweep++) {
      change = 0;
      for (const state of core) {
        let [value, going] = [rewards[state], end[state]];
        for (const [next, chance] of after[state]) {
          value += chance * values[next];
          going += chance;
        }
        change = Math.max(change, Math.abs(value / going - values[state]) / scale(value / going));
        values[state] = value / going;
      }
    }
    for (const state of order.reverse()) {
      for (const [next, chance] of after[state]) values[state] = plus(values[state], chance * values[next]);
    }
    return values;
  }

  /** Return random actions, without those that risk an endless episode where it can be ended for sure. */
  firstPolicy() {
    const policy = this.policy("random");
    if (this.discount < 1) return policy;
    const safe = policy.map((row) => row.map(() => 1));
    const leads = (state, action, isSure, wanted) =>
      this.rows[state][action].some(({ over, shift }) => (over === 1 || isSure.has(state + shift)) === wanted);
    let isSure;
    for (let count = -1; count !== sum(safe.flat()); ) {
      count = sum(safe.flat());
      isSure = new Set();
      for (let size = -1; size !== isSure.size; ) {
        ({ size } = isSure);
        for (const state of this.states) {
          if (safe[state].some((can, action) => can && leads(state, action, isSure, true))) isSure.add(state);
        }
      }
      for (const state of this.states) {
        safe[state] = safe[state].map((can, action) => Number(can && !leads(state, action, isSure, false)));
      }
    }
    for (const state of isSure) {
      const row = policy[state].map((weight, action) => weight * safe[state][action]);
      policy[state] = sum(row) > 0 ? row.map((weight) => weight / sum(row)) : only(row, safe[state].indexOf(1));
    }
    return policy;
  }

  /** Improve a policy where an action is better than what it does, and return in how many states. */
  improve(policy, values) {
    const better = this.states.filter((state) => {
      const ahead = this.ahead(values, state);
      const isBetter = Math.max(...ahead) > values[state] + TOLERANCE * scale(values[state]);
      if (isBetter) policy[state] = only(ahead, greedy(ahead)[0]);
      return isBetter;
    });
    return better.length;
  }

  /** Return the optimal values: from the policy that the page knows on, if it is one for this discount. */
  optimum() {
    const { policy: known, discount = 1 } = this.data;
    const policy = this.firstPolicy();
    for (const state of this.states) {
      const action = this.discount < 1 || discount === 1 ? (known?.[state] ?? -1) - this.first : -1;
      if (action >= 0) policy[state] = only(policy[state], action);
    }
    let values = this.valuesOf(policy);
    for (let round = 1; round < LONGEST && this.improve(policy, values) > 0; round++) values = this.valuesOf(policy);
    return values;
  }
}

/** Return the states that are in both of two problems, by cell and by what is held, on, or moved: numbers by numbers. */
function commonStates(before, after) {
  const [old, now] = [before, after].map(({ reached, data: { width, height, starts, things = [] } }) => {
    const cells = width * height;
    const own = things.filter(({ kind }) => kind in COMMON.needed || kind === "mover");
    const first = Math.floor(starts[0] / cells);
    return new Map(
      reached.map((state) => {
        const [at, cell] = [Math.floor(state / cells), state % cells];
        const changed = own.filter(({ values }) => values[at] !== values[first]);
        const told = changed.map(({ kind, name, values }) => [kind, name, values[at]]);
        return [JSON.stringify([cell % width, Math.floor(cell / width), told]), state];
      }),
    );
  });
  return new Map([...old].filter(([key]) => now.has(key)).map(([key, state]) => [state, now.get(key)]));
}

/** Return the number of a state and an action. */
const slotOf = ({ state, action }) => SIDES.length * state + action;

/** One run of an algorithm on a level. */
export class Learner {
  /** @param {LevelData} data @param {Partial<typeof USUAL>} options */
  constructor(data, options) {
    this.options = { ...USUAL, ...options };
    const { algorithm } = this.options;
    this.unit = UNITS[algorithm] ?? "episode";
    this.isPrediction = algorithm === "policy_evaluation" || algorithm === "monte_carlo";
    this.number = 0; // Of sweeps, rounds or episodes.
    this.returns = [];
    this.changes = new Set(); // The numbers at which the level has changed.
    this.way = []; // The states of the episode at hand.
    this.memory = []; // The last step for each state and action, told by their places here.
    this.places = new Map();
    this.begin(data);
    this.errors = [this.error()];
  }

  /** Begin in a level without any knowledge. */
  begin(data) {
    const { algorithm, initial, policy } = this.options;
    this.problem = new Problem(data, this.options);
    this.most = data.max_steps ?? LONGEST;
    this.values = new Float64Array(this.problem.size);
    this.visits = new Float64Array(this.problem.size); // Of Monte Carlo: how many returns a value is the mean of.
    /** What is known of each action: its probability in a policy, or its value. */
    this.actions = this.isPrediction ? this.problem.policy(policy) : null;
    this.exact = this.isPrediction ? this.problem.valuesOf(this.actions) : this.problem.optimum();
    if (algorithm === "sarsa" || algorithm === "q_learning") {
      this.actions = this.problem.rows.map((row) => row.map(() => initial));
      this.values = this.values.map((_, state) => (this.problem.rows[state] ? initial : 0));
    }
    this.updates = this[algorithm]();
  }

  /**
   * Go on in the level after a change, with what was learned of the states that both have. What is remembered of
   * their actions stays as it was until they are tried again.
   *
   * @param {LevelData} data
   * @returns {number} How many states both have.
   */
  follow(data) {
    const { problem, values, visits, actions, isPrediction } = this;
    this.changes.add(this.number);
    this.begin(data);
    const kept = commonStates(problem, this.problem);
    if (actions !== null && !isPrediction) this.actions ??= this.problem.firstPolicy();
    for (const [before, state] of kept) {
      this.values[state] = values[before];
      this.visits[state] = visits[before];
      if (this.actions !== null && !isPrediction) this.actions[state] = actions[before];
    }
    this.memory = this.memory.flatMap((step) => {
      const [state, next] = [kept.get(step.state), kept.get(step.next)];
      const ahead = step.ahead ?? (next === undefined ? values[step.next] : undefined);
      return state === undefined ? [] : [{ ...step, state, next, ahead }];
    });
    this.places = new Map(this.memory.map((step, place) => [slotOf(step), place]));
    const here = this.isOver ? undefined : kept.get(this.way.at(-1));
    this.way = here === undefined ? [] : this.way.map((state) => kept.get(state) ?? here);
    return kept.size;
  }

  /** Learn from one more state, step or round, and return what happened; null after the end. */
  step() {
    return this.updates.next().value ?? null;
  }

  /** Learn to the end of the sweep, round or episode, and return what happened last; null after the end. */
  finish() {
    const { number } = this;
    let update;
    do update = this.step();
    while (update !== null && this.number === number);
    return update;
  }

  /** Return the greedy actions of a state. */
  best(state) {
    return greedy((!this.isPrediction && this.actions?.[state]) || this.problem.ahead(this.values, state));
  }

  /** Return whether anything has been learned of a state. */
  knows(state) {
    if (this.unit !== "episode") return this.number > 0 || this.values[state] !== 0;
    if (this.isPrediction) return this.visits[state] > 0;
    return this.actions[state].some((value) => value !== 0);
  }

  /** Return the root of the mean square of the differences from the exact values, where these are finite. */
  error() {
    const finite = this.problem.reached.filter((state) => Number.isFinite(this.exact[state]));
    return Math.sqrt(sum(finite.map((state) => (this.values[state] - this.exact[state]) ** 2)) / finite.length);
  }

  /** Count a sweep, a round, or an episode with its return. */
  count(total) {
    if (total !== undefined) this.returns.push(total);
    this.number += 1;
    this.errors.push(this.error());
  }

  value_iteration() {
    return this.sweeps((ahead) => Math.max(...ahead));
  }

  policy_evaluation() {
    return this.sweeps((ahead, state) => sum(ahead.map((value, action) => this.actions[state][action] * value)));
  }

  *sweeps(backup) {
    const { states } = this.problem;
    for (let delta = Infinity; delta > CONVERGED; ) {
      const before = this.values.slice();
      delta = 0;
      for (const state of states) {
        const parts = this.problem.ahead(before, state);
        this.values[state] = backup(parts, state);
        delta = Math.max(delta, Math.abs(this.values[state] - before[state]));
        if (state === states.at(-1)) this.count();
        yield { state, value: this.values[state], parts };
      }
    }
  }

  *policy_iteration() {
    this.actions ??= this.problem.firstPolicy();
    for (let changed = 1; changed > 0 && this.number < LONGEST; ) {
      this.values = this.problem.valuesOf(this.actions);
      changed = this.problem.improve(this.actions, this.values);
      this.count();
      yield { changed };
    }
  }

  *monte_carlo() {
    const { problem, values, visits } = this;
    this.random ??= new Generator(this.options.seed);
    const draw = (chances) => {
      const sums = [];
      for (const chance of chances) sums.push((sums.at(-1) ?? 0) + chance);
      const drawn = this.random.random();
      return sums.findIndex((part) => part / sums.at(-1) > drawn);
    };
    const { starts } = problem.data;
    for (;;) {
      const steps = [];
      this.way = [starts[draw(starts.map(() => 1 / starts.length))]];
      for (let over = 0; !over && steps.length < this.most; ) {
        const state = this.way.at(-1);
        const action = draw(this.actions[state]);
        const step = this.go(state, action, (row) => row[draw(row.map(({ chance }) => chance))]);
        ({ over } = step);
        steps.push(step);
        yield { step };
      }
      const first = new Map(steps.map(({ state }, time) => /** @type {const} */ ([state, time])).reverse());
      let total = 0;
      for (let time = steps.length - 1; time >= 0; time--) {
        const { state, reward } = steps[time];
        total = reward + problem.discount * total;
        if (first.get(state) < time) continue; // Only the first visit of an episode counts.
        const before = values[state];
        visits[state] += 1;
        values[state] += (total - before) / visits[state];
        if (time === 0) this.count(total);
        yield { state, before, target: total, visits: visits[state], value: values[state] };
      }
    }
  }

  q_learning() {
    return this.episodes(this.q_learning_episode);
  }

  sarsa() {
    return this.episodes(this.sarsa_episode);
  }

  *episodes(episode) {
    const { reached, data } = this.problem;
    const drawn = (random, states) => states[random.integer(states.length)];
    if (this.random === undefined) {
      this.random = new Generator(this.options.seed);
      this.world = new Generator(this.random.integer(2 ** 31));
      drawn(this.world, data.starts); // The environment is reset for its seed, and then for each episode.
    }
    for (; ; this.way = []) {
      if (this.way.length === 0) {
        this.way = [this.options.exploring_starts ? drawn(this.random, reached) : drawn(this.world, data.starts)];
        this.total = 0;
      }
      yield* episode.call(this, this.way.at(-1));
    }
  }

  *q_learning_episode(state) {
    for (let isLast = false; !isLast; ) {
      const step = this.act(state, this.choose(state));
      const update = this.learnGreedily(step);
      this.plan(step);
      isLast = this.ends(step);
      if (isLast) this.count(this.total);
      state = step.next;
      yield { ...update, step };
    }
  }

  *sarsa_episode(state) {
    let action = this.choose(state);
    let waiting = []; // The steps that are not yet learned from.
    for (let isLast = false; !isLast; ) {
      const step = this.act(state, action);
      [state, action] = [step.next, this.choose(step.next)];
      const ahead = step.over ? 0 : this.actions[state][action];
      waiting.push(step);
      isLast = this.ends(step);
      if (waiting.length < this.options.n_steps && !isLast) yield { step };
      for (; waiting.length >= (isLast ? 1 : this.options.n_steps); waiting = waiting.slice(1)) {
        const target = waiting.reduceRight((later, { reward }) => reward + this.problem.discount * later, ahead);
        const update = this.learn(waiting[0], target);
        if (isLast && waiting.length === 1) this.count(this.total);
        yield { ...update, step, ahead, rewards: waiting.length };
      }
    }
  }

  /** Return an action, epsilon-greedily. */
  choose(state) {
    const row = this.actions[state] ?? only(this.actions[this.way[0]], -1); // None is better at the end.
    if (this.random.random() < this.options.epsilon) return this.random.integer(row.length);
    const best = Math.max(...row);
    const ties = [...row.keys()].filter((action) => row[action] === best);
    return ties[this.random.integer(ties.length)];
  }

  /** Take an action in the environment. */
  act(state, action) {
    return this.go(state, action, (row) => {
      if (row.length === 1) return row[0];
      const drawn = this.world.random();
      let part = 0;
      return row.find(({ chance }) => drawn < (part += chance)) ?? row.at(-1);
    });
  }

  /** Go on with one of the outcomes of an action. */
  go(state, action, choose) {
    const outcome = choose(this.problem.rows[state][action]);
    const next = state + outcome.shift;
    this.way.push(next);
    return { ...outcome, state, action, next };
  }

  /** Add the reward of a step to the return, and return whether it is the last one of its episode. */
  ends({ reward, over }) {
    const steps = this.way.length - 1;
    this.total += this.problem.discount ** (steps - 1) * reward;
    this.isOver = over === 1 || steps >= this.most;
    return this.isOver;
  }

  /** Move the value of a step's action towards a target. */
  learn({ state, action }, target) {
    const row = this.actions[state];
    const before = row[action];
    row[action] += this.options.step_size * (target - before);
    this.values[state] = Math.max(...row);
    return { state, action, before, target, value: row[action] };
  }

  /** Learn from a step as if the best action followed. */
  learnGreedily(step) {
    const ahead = step.over ? 0 : (step.ahead ?? this.values[step.next]);
    return { ...this.learn(step, step.reward + this.problem.discount * ahead), ahead, rewards: 1 };
  }

  /** Remember a step in the place of the last one like it, and learn from remembered ones. */
  plan(step) {
    const { planning_steps } = this.options;
    const key = slotOf(step);
    if (!this.places.has(key)) this.places.set(key, this.memory.length);
    this.memory[this.places.get(key)] = step;
    for (let time = 0; time < planning_steps; time++)
      this.learnGreedily(this.memory[this.random.integer(this.memory.length)]);
  }
}
