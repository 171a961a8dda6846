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
