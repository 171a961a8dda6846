import assert from "node:assert/strict";
import { test } from "node:test";
import { checked } from "../../babyrobot_levels/render/static/checks.js";
import { formatted, Game, swiped } from "../../babyrobot_levels/render/static/game.js";
import { checksum, playOf, signed } from "../../babyrobot_levels/render/static/play.js";
import { decisionsOf } from "../../babyrobot_levels/render/static/regret.js";
import { resultFacts, ruleOf, starsOf, verdictOf } from "../../babyrobot_levels/render/static/result.js";
import { surroundings } from "../../babyrobot_levels/render/static/speech.js";
import { corridor } from "./page.js";

const EAST = 2;

/** Play until the episode ends. */
function finished(changes = {}) {
  const game = new Game(corridor(changes));
  while (game.end === null) game.step(EAST);
  return game;
}

test("an episode ends at the exit, and its rewards add up", () => {
  const game = finished({ max_steps: null });
  assert.equal(game.end, "exit");
  assert.equal(game.isGood, true);
  assert.equal(game.total, 10 - (game.steps - 1));
});

test("an episode ends after the most steps", () => {
  const game = finished({ max_steps: 1 });
  assert.deepEqual([game.end, game.isGood, game.cause], ["time", false, "Time limit reached"]);
});

test("later rewards count less with a discount", () => {
  const game = new Game(corridor({ discount: 0.5 }));
  game.step(0);
  game.step(0);
  assert.equal(game.total, -1.5);
});

test("the same action has the same outcome again after undo", () => {
  const game = new Game(corridor());
  game.step(EAST);
  const outcome = game.step(EAST);
  game.undo();
  assert.deepEqual([game.state, game.end, game.undone], [1, null, 1]);
  assert.deepEqual(game.step(EAST), outcome);
});

test("steps are described", () => {
  const game = new Game(corridor());
  assert.equal(game.describeStep(game.step(1)), "Blocked by a wall to the north: \u22121");
  assert.equal(game.describeStep(game.step(EAST)), "Moved east to [1, 0]: \u22121");
  assert.equal(
    surroundings(game),
    "The robot is at [1, 0]. Closed: north and south. The exit is 1 column east. The level has 3 columns and 1 rows.",
  );
});

test("a hint counts once for each step", () => {
  const game = new Game(corridor());
  assert.deepEqual([game.hint(), game.hint(), game.hints], [EAST, EAST, 1]);
});

test("numbers have two decimals, or two digits", () => {
  assert.deepEqual([1.005, -0.5, 0.00123456, 1e-9].map(formatted), ["1", "\u22120.5", "0.0012", "0"]);
});

/** Play an episode whose next random numbers are given. */
function lucky(draws, actions, changes = {}) {
  const game = new Game(corridor(changes));
  game.random.random = () => draws.shift();
  for (const action of actions) game.step(action);
  return game;
}

test("stars are given by decisions, and not by luck", () => {
  const hole = { exits: [], rows: corridor().rows.map((row) => row.map((each) => (each === 10 ? -10 : each))) };
  const of = (...episode) => starsOf(lucky(...episode));
  assert.equal(of([0.9, 0.9, 0.1], [EAST, EAST, EAST, EAST]), 3);
  assert.equal(of([0.9, 0.9, 0.9], [EAST, EAST, EAST, EAST]), 3);
  // Each step that is wasted costs what it pays, and a chance less.
  assert.equal(of([0.1], [0, EAST, EAST]), 1);
  assert.equal(of([0.1], [0, EAST, EAST], { max_steps: null, returns: free() }), 1);
  assert.equal(of([], [0, 0, 0, 0]), 0);
  assert.equal(of([0.1], [EAST, EAST], hole), 0);
  assert.equal(starsOf(lucky([], [0, 0], { returns: undefined })), null);
});

/** Return what is known of the corridor without a limit. */
const free = (changes = {}) => ({ best: 8, random: 2, values: [8, 9, null], ...changes });

test("decisions that cost little earn two stars", () => {
  const stars = (random) => starsOf(lucky([0.1], [0, EAST, EAST], { max_steps: null, returns: free({ random }) }));
  assert.deepEqual([-2, -1.9, null].map(stars), [2, 1, 1]);
});

test("regret and luck add up to what a return is less than the optimum", () => {
  const game = lucky([0.9, 0.9, 0.1], [0, EAST, EAST, EAST, EAST], { max_steps: null, returns: free() });
  assert.deepEqual(decisionsOf(game), { cost: 1, luck: -1, optimum: 8 });
  const late = lucky([0.9, 0.1], [0, EAST, EAST, EAST]);
  const { cost, luck, optimum } = decisionsOf(late);
  assert.equal(optimum, -1 + 0.5 * 10 + 0.5 * (-1 + 0.5 * 10 + 0.5 * (-1 + 0.5 * 10 - 0.5)));
  assert.ok(Math.abs(late.total - (optimum - cost + luck)) < 1e-12);
});

test("with few steps left, another action than that of the policy may be the best", () => {
  const dear = corridor().rows.map((row) => row.map((each, at) => (at % 6 === 2 && each < 0 ? -20 : each)));
  const game = new Game(corridor({ rows: [[1, 0, 0, 0, 0, 0], ...dear.slice(1)], max_steps: 1 }));
  assert.equal(game.best, 0);
  assert.equal(new Game(corridor()).best, EAST);
});

test("a result tells decisions and luck apart, and help only where there was some", () => {
  const game = lucky([0.9, 0.1], [EAST, EAST, EAST], { max_steps: null, returns: free() });
  assert.deepEqual(resultFacts(game), [
    ["Return", "8"],
    ["Decisions", "cost 0"],
    ["Luck", "0"],
  ]);
  game.hint();
  game.hints = 1;
  assert.deepEqual(resultFacts(game).at(-1), ["Help", "1 hint"]);
  assert.deepEqual(resultFacts(lucky([], [0], { returns: undefined })), [["Return", "\u22121"]]);
  assert.match(ruleOf(game), /cost at most 0.6 of the return/);
  assert.doesNotMatch(ruleOf(lucky([], [], { returns: free({ random: null }) })), /Two/);
});

test("what ended an episode is told by its name", () => {
  const hole = [[], "hole: ends the episode, pays 0", [2, 1]];
  const ended = (changes) => {
    const game = lucky([0.1], [EAST, EAST], changes);
    return [game.end, game.cause];
  };
  assert.deepEqual(ended({}), ["exit", "Exit reached"]);
  assert.deepEqual(ended({ exits: [], good_ends: [], rules: [hole] }), ["over", "Hole at [2, 0]"]);
  assert.deepEqual(ended({ exits: [], good_ends: [2] }), ["good", "Ended at [2, 0]"]);
});

test("a play has the episode and its checksum", () => {
  const line = signed(playOf(finished({ max_steps: 1 })));
  const play = JSON.parse(line);
  assert.deepEqual([play.digest, play.seed, play.actions, play.end], ["abc", "7", [EAST], "truncated"]);
  const summed = line.slice(0, line.lastIndexOf(',"checksum"'));
  assert.equal(play.checksum, checksum(new TextEncoder().encode(summed)).toString(16).padStart(8, "0"));
  assert.equal(playOf(new Game(corridor({ code: undefined }))), null);
});

test("a swipe is far enough, and goes to the side that it is nearest to", () => {
  assert.deepEqual(
    [
      [20, -20],
      [9, -40],
      [50, 30],
      [3, 28],
      [-30, 29],
    ].map(([dx, dy]) => swiped(dx, dy)),
    [0, 1, 2, 3, 4],
  );
});

test("checksums are CRC-32, also in parts", () => {
  const bytes = new TextEncoder().encode("123456789");
  assert.equal(checksum(bytes), 0xcbf43926);
  assert.equal(checksum(bytes.subarray(4), checksum(bytes.subarray(0, 4))), 0xcbf43926);
});

/** Return a corridor with a key and a lever, in four configurations. */
function things() {
  const thing = (kind, name, values) => ({ kind, name, values, looks: [[], []] });
  return {
    things: [thing("item", "key", [0, 1, 0, 1]), thing("switch", "lever", [0, 0, 1, 1])],
    possible: Array(12).fill(1),
    marks: { values: [...Array(12).keys()], policy: [] },
  };
}

test("what can be held and on is told in words, fewer first", () => {
  const game = new Game(corridor(things()));
  assert.deepEqual(
    [...game.things.situations(4)],
    [
      ["Nothing", 0],
      ["key", 1],
      ["lever on", 2],
      ["key, lever on", 3],
    ],
  );
});

test("marks are those of a configuration", () => {
  const game = new Game(corridor(things()));
  assert.deepEqual([game.marks("values"), game.marks("values", 2), game.marks("policy")], [[0, 1, 2], [6, 7, 8], []]);
});

test("a watched episode has no stars, and no verdict", () => {
  const game = finished();
  assert.notEqual(starsOf(game), null);
  game.watched = 1;
  assert.deepEqual([starsOf(game), verdictOf(game)], [null, null]);
});

test("the verdict tells how many steps were wasted", () => {
  const plain = { rows: corridor().rows.map((row) => row.map((each) => (each === 10 ? -1 : each))) };
  assert.equal(verdictOf(lucky([0.1], [EAST, EAST], plain)), "Best possible!");
  assert.match(verdictOf(lucky([0.1], [1, EAST, EAST], plain)), /more than needed$/);
  assert.equal(verdictOf(finished({ max_steps: 1 })), null);
});

test("a way leads towards a cell, and nowhere through walls", () => {
  const game = new Game(corridor());
  assert.equal(game.towards(2), EAST);
  assert.equal(game.towards(0), -1);
  const shut = new Game(corridor({ possible: [1, 1, 1] }));
  assert.equal(shut.towards(2), -1);
});

test("a robot that moves diagonally has nine actions", () => {
  const southEast = 6;
  const [stay, bump, toExit] = [
    [1, 0, -1, 0, 0, 0],
    [1, 0, -1, 0, 3, 0],
    [1, 3, 10, 1, 1, 0],
  ];
  const shut = [0, ...Array(8).fill(1)];
  const data = corridor({
    width: 2,
    height: 2,
    exits: [3],
    rows: [stay, bump, toExit],
    table: [shut.with(southEast, 2), shut, shut, Array(9).fill(-1)].flat(),
    possible: [0b1000001, 1, 1, 0],
    policy: [southEast, 0, 0, -1],
  });
  const game = new Game(checked(data));
  assert.deepEqual([game.actions, game.best, game.towards(3)], [9, southEast, southEast]);
  assert.equal(game.describeHint(southEast), "Hint: move south-east.");
  assert.deepEqual(game.pointers(southEast), [{ place: [0, 0], side: 1.5 }]);
  assert.equal(game.describeStep(game.step(5)), "Blocked by a wall to the north-east: \u22121");
  assert.equal(game.describeStep(game.step(southEast)), "Moved south-east to [1, 1]: +10");
  assert.equal(game.end, "exit");
});
