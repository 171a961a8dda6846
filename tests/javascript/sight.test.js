import assert from "node:assert/strict";
import { test } from "node:test";
import { Game } from "../../babyrobot_levels/render/static/game.js";
import { inPercent, Sight } from "../../babyrobot_levels/render/static/sight.js";
import { corridor } from "./page.js";

const [EAST, WEST] = [2, 4];
const OWN_CELL = { field: [0, 0, 0], fields: [[0, 0]] };

/** The corridor, through a sight that shows the same everywhere, or what is given. */
function foggy(sight = {}, changes = {}) {
  const data = corridor({ sight: { shown: [0, 0, -1], ...OWN_CELL, ...sight }, walker: "sight", ...changes });
  const game = new Game(data);
  game.sight = new Sight(data);
  game.sight.begin(game.state);
  return game;
}

const belief = (game) => Object.fromEntries(game.sight.now.belief);

test("at first, all starts that look alike are equally likely", () => {
  assert.deepEqual(belief(foggy({}, { starts: [0, 1] })), { 0: 0.5, 1: 0.5 });
  assert.equal(Object.keys(belief(foggy({ shown: [0, 1, -1] }, { starts: [0, 1] }))).length, 1);
});

test("a belief follows from what actions do, and from the episode that goes on", () => {
  const game = foggy({}, { starts: [0, 1] });
  game.state = 0;
  game.step(EAST);
  // From the start, the robot is in the middle; from there, it skidded, or the episode would be over.
  assert.deepEqual(belief(game), { 1: 1 });
  assert.equal(game.sight.told, "You can know how everything stands.");
  game.undo();
  assert.deepEqual(belief(game), { 0: 0.5, 1: 0.5 });
  assert.match(game.sight.told, /2 possibilities; you can be 50 % sure/);
});

test("unequal chances are weighed", () => {
  const game = foggy({}, { starts: [0, 1, 1] });
  game.state = 1;
  game.step(0);
  assert.deepEqual(belief(game), { 0: 1 / 3, 1: 2 / 3 });
  assert.deepEqual(game.sight.places(game.things), [
    ["robot", 0, 1 / 3],
    ["robot", 1, 2 / 3],
  ]);
});

test("cells are seen around the robot, and remembered", () => {
  const game = foggy({ fields: [[0, 0, 1, 0, 0, -1]] });
  assert.deepEqual([...game.sight.now.seen], [0, 1]);
  game.step(EAST);
  const { seen, before } = game.sight.now;
  assert.deepEqual([[...seen], [...before]], [[1, 2], [0, 1]]); // biome-ignore format: pairs
  assert.equal(foggy({ fields: undefined }).sight.now.seen.size, 3);
});

test("the best agent goes by what it has seen, and on without memory where nothing is known", () => {
  const nodes = [[EAST, [], [], [0, 1], [], []], [-1]];
  const game = foggy({ roots: [0, 0], nodes, agents: [[[0, 0, 0, 0, 1]]] });
  assert.equal(game.advice(), EAST);
  assert.equal(game.hint(), EAST);
  game.step(EAST);
  assert.equal(game.advice(), WEST);
  game.undo();
  game.step(0);
  assert.equal(game.advice(), -1);
});

test("probabilities are told in percent, and never as certain", () => {
  assert.deepEqual([0.0001, 1 / 3, 0.9999].map(inPercent), ["under 1 %", "33 %", "over 99 %"]);
});
