import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { Game } from "../../babyrobot_levels/render/static/game.js";
import { inPython, toldUpdate } from "../../babyrobot_levels/render/static/learned.js";
import { Learner } from "../../babyrobot_levels/render/static/learner.js";
import { corridor } from "./page.js";

// What Python learns, for some levels: see `tests/support/learned.py`.
const RUNS = JSON.parse(readFileSync(new URL("learned.json", import.meta.url), "utf8"));

for (const { name, data, runs } of RUNS) {
  for (const { options, number, values, returns } of runs) {
    test(`${options.algorithm} learns ${name} as Python does`, () => {
      const learner = new Learner(data, options);
      while (learner.number < number) assert.notEqual(learner.finish(), null);
      const found = learner.problem.states.map((state) => learner.values[state]);
      for (const [kind, expected, actual] of [
        ["value", values, found],
        ["return", returns, learner.returns],
      ]) {
        if (expected === null) continue;
        assert.equal(actual.length, expected.length);
        expected.forEach((value, index) => {
          assert.ok(
            Math.abs(value - actual[index]) < 1e-9 * Math.max(1, Math.abs(value)),
            `${kind} ${index}: ${actual[index]}, not ${value}`,
          );
        });
      }
    });
  }
}

/** Learn some updates of the corridor, and tell the last one. */
function told(steps, options = {}) {
  const learner = new Learner(corridor(), { discount: 1, actions: "all", ...options });
  let update;
  for (let step = 0; step < steps; step++) update = learner.step();
  return toldUpdate(new Game(corridor()), learner, update);
}

test("updates are told with their numbers", () => {
  assert.equal(
    told(1, { algorithm: "value_iteration" }),
    "V([0, 0]) ← max(stay −1, north −1, east −1, south −1, west −1) = −1",
  );
  assert.equal(
    told(1, { algorithm: "policy_iteration" }),
    "Round 1: the policy's exact values, and a better action in 2 states.",
  );
  assert.match(told(1), /^Q\(\[0, 0\], \w+\) ← 0 \+ 0\.1 · \(−1 \+ 1 · 0 − 0\) = −0\.1$/);
  assert.match(told(1, { planning_steps: 3 }), /, and 3 planned$/);
  assert.match(told(1, { algorithm: "sarsa", n_steps: 2 }), /^\[0, 0\], \w+: reward −1$/);
  assert.match(told(2, { algorithm: "sarsa", n_steps: 2 }), /\(G − 0\) = .*, where G = −?\d+: 2 rewards, and then 0$/);
  assert.match(told(5, { algorithm: "monte_carlo" }), /^V\(.*\) ← 0 \+ 1\/1 · \(−?\d+ − 0\) = −?\d+$/);
});

test("a negative number after an operator is in parentheses", () => {
  const all = Array.from({ length: 40 }, (_, at) => told(at + 1));
  assert(all.some((text) => /− \(−[\d.]+\)\) =/.test(text)));
  assert(all.every((text) => !/[·−] −/.test(text)));
});

test("a sweep ends with its last state, and the sweeps when nothing changes", () => {
  const learner = new Learner(corridor(), { algorithm: "value_iteration", discount: 0.5 });
  learner.step();
  assert.equal(learner.number, 0);
  learner.step();
  assert.equal(learner.number, 1);
  while (learner.finish() !== null);
  assert.ok(learner.error() < 1e-9);
});

test("the optimum is found without a known policy, and for other discounts", () => {
  const best = (discount, policy) => new Learner(corridor({ policy }), { discount }).exact[0];
  assert.ok(Math.abs(best(1, null) - 8) < 1e-9);
  assert.ok(Math.abs(best(1, [2, 2, -1]) - 8) < 1e-9);
  // In the middle v = 0.5 * 10 + 0.5 * (-1 + 0.5 v), so 6.
  assert.ok(Math.abs(best(0.5, [0, 0, -1]) - (-1 + 0.5 * 6)) < 1e-9);
});

test("a run is a program in Python", () => {
  const learner = new Learner(corridor(), { algorithm: "sarsa", discount: 0.9, n_steps: 4, seed: "3" });
  assert.match(
    inPython(corridor(), learner),
    /brl\.sarsa\(\n {4}level,\n {4}discount=0\.9,\n(.*\n)* {4}n_steps=4,\n\)/,
  );
});

// -- a level that changes --------------------------------------------------------------------------

const EAST = 1; // Of the moves.

/** The corridor with one more cell, before its exit. */
const LONGER = corridor({
  width: 4,
  table: [0, 3, 1, 3, 3, 0, 3, 1, 3, 2, 0, 3, 4, 3, 2, -1, -1, -1, -1, -1],
  possible: [0b00101, 0b10101, 0b10101, 0],
  policy: null,
});

/** That one with a wall in the east of its first cell. */
const WALLED = { ...LONGER, table: LONGER.table.with(2, 3).with(9, 3) };

/** Learn some episodes or sweeps of a level. */
function learned(data, count, options = {}) {
  const learner = new Learner(data, { discount: 0.9, ...options });
  while (learner.number < count && learner.finish() !== null);
  return learner;
}

test("what was learned is kept for states that are still there", () => {
  const learner = learned(corridor(), 50, { initial: 3 });
  const before = structuredClone(learner.actions);
  const values = [...learner.values];
  learner.follow(LONGER);
  assert.deepEqual(learner.actions.slice(0, 2), before.slice(0, 2));
  assert.deepEqual([...learner.values], [values[0], values[1], 3, 0]);
  while (learner.number < 100) learner.finish();
  assert.notEqual(learner.values[2], 3);
  learner.follow(corridor());
  assert.equal(learner.values[2], 0);
  learner.follow(LONGER);
  assert.deepEqual(learner.actions[2], [3, 3, 3, 3]);
});

test("states are the same with the same things", () => {
  const take = [1, 4, -1, 0, 1, 0]; // To the next cell, and the other configuration.
  const rows = [...corridor().rows, take, [1, -2, -1, 0, 1, 0]];
  const [bumps, ends] = [Array(5).fill(3), Array(5).fill(-1)];
  const [begin, beyond] = [
    [0, 3, 5, 3, 3],
    [0, 3, 4, 3, 2],
  ];
  const thing = (values) => [{ kind: "item", name: "key", values, cells: [[1], []] }];
  const [nothing, key] = [
    [begin, bumps, ends],
    [bumps, beyond, ends],
  ];
  const last = [[0, 3, 6, 3, 3], bumps, ends];
  const first = corridor({
    rows,
    things: thing([0, 1]),
    table: [...nothing, ...key].flat(),
    possible: Array(6).fill(30),
  });
  const other = { ...first, things: thing([1, 0]), table: [...key, ...last].flat(), starts: [3] };
  const learner = learned({ ...first, policy: null }, 20);
  const [start, held] = [learner.values[0], learner.values[4]];
  assert.ok(held > 0);
  learner.follow({ ...other, policy: null });
  assert.deepEqual([learner.values[3], learner.values[1]], [start, held]);
});

test("the model of Dyna is as the level was until it is tried again", () => {
  for (const [name, changed] of [
    ["a wall", WALLED],
    ["no cell", corridor({ width: 1, starts: [0], exits: [], table: [0, 3, 3, 3, 3], possible: [1], policy: null })],
  ]) {
    const learner = learned(LONGER, 300, { planning_steps: 20 });
    const before = learner.actions[0][EAST];
    learner.follow(changed);
    learner.options.planning_steps = 500;
    learner.way = [0];
    learner.actions[0][EAST] = 0; // Planning brings it back.
    learner.plan(learner.act(0, 0));
    assert.ok(learner.actions[0][EAST] >= before - 1e-2, `${name} is not known yet`);
    learner.plan(learner.act(0, EAST));
    assert.ok(learner.actions[0][EAST] < before - 0.5, `${name} is known`);
  }
});

test("an episode goes on where the robot is, if it can be there", () => {
  const learner = new Learner(LONGER, {});
  while (learner.way.at(-1) !== 1) learner.step();
  const { length } = learner.way;
  learner.follow(WALLED);
  assert.equal(learner.step().step.state, 1);
  assert.equal(learner.way.length, length + 1);
  learner.follow(corridor({ width: 1, starts: [0], exits: [], table: [0, 3, 3, 3, 3], possible: [1], policy: null }));
  assert.equal(learner.step().step.state, 0);
  assert.equal(learner.way.length, 2);
});

for (const algorithm of ["value_iteration", "policy_evaluation", "policy_iteration"]) {
  test(`${algorithm} goes on to the values of the level that has changed`, () => {
    const learner = learned(corridor(), Infinity, { algorithm });
    const [before, { number }] = [learner.values[0], learner];
    for (const changed of [LONGER, WALLED, corridor()]) {
      learner.follow(changed);
      while (learner.finish() !== null);
      assert.ok(learner.error() < 1e-9);
    }
    assert.ok(learner.number > number);
    assert.ok(Math.abs(learner.values[0] - before) < 1e-9);
  });
}

for (const algorithm of ["monte_carlo", "sarsa"]) {
  test(`${algorithm} goes on in the middle of an episode`, () => {
    const learner = learned(corridor(), 20, { algorithm, n_steps: 3 });
    learner.step();
    const [value, visits] = [learner.values[0], learner.visits[0]];
    learner.follow(LONGER);
    assert.deepEqual([learner.values[0], learner.visits[0]], [value, visits]);
    while (learner.number < 40) learner.finish();
    assert.notEqual(learner.values[2], 0);
  });
}
