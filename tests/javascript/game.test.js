import assert from "node:assert/strict";
import { test } from "node:test";
import { formatted, Game, swiped } from "../../babyrobot_levels/render/static/game.js";
import { checksum, playLine } from "../../babyrobot_levels/render/static/play.js";
import { resultFacts, starsOf, titleOf } from "../../babyrobot_levels/render/static/result.js";
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
  assert.deepEqual([game.end, game.isGood, titleOf(game)], ["time", false, "Time limit reached"]);
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

test("stars are given by the return", () => {
  const stars = (total, isGood = false) => starsOf({ known: corridor(), total, isGood });
  assert.deepEqual(
    [8, 7.4, 7.3, 2.5, 2].map((total) => stars(total)),
    [3, 2, 1, 1, 0],
  );
  assert.equal(stars(-5, true), 1);
});

test("a result tells the luck, and help only where there was some", () => {
  const game = finished({ max_steps: null });
  game.total = 8;
  assert.deepEqual(resultFacts(game).slice(0, 2), [
    ["Return", "8"],
    ["Best average", "8.00"],
  ]);
  const told = new Map(resultFacts(game));
  assert.equal(told.get("Luck"), "better than 25 %, equal to 50 %, worse than 25 % of the optimal policy's episodes");
  assert.equal(told.has("Help"), false);
});

test("a play has the episode and its checksum", () => {
  const line = playLine(finished({ max_steps: 1 }));
  const play = JSON.parse(line);
  assert.deepEqual([play.digest, play.seed, play.actions, play.end], ["abc", "7", [EAST], "truncated"]);
  const summed = line.slice(0, line.lastIndexOf(',"checksum"'));
  assert.equal(play.checksum, checksum(new TextEncoder().encode(summed)).toString(16).padStart(8, "0"));
  assert.equal(playLine(new Game(corridor({ code: undefined }))), null);
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
