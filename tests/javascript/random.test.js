import assert from "node:assert/strict";
import { test } from "node:test";
import { Generator } from "../../babyrobot_levels/render/static/random.js";

// Of `numpy.random.default_rng(seed)`: `integers` below 3, 1, 10, 1000 and 7, then `random()`.
const NUMPY = [
  ["0", [2, 0, 6, 511, 1], 0.04097352393619469],
  ["7", [2, 0, 6, 684, 6], 0.7756856902451935],
  ["1099511627781", [0, 0, 0, 449, 2], 0.5872294266977701],
  [`1${"0".repeat(39)}`, [1, 0, 6, 100, 1], 0.7725172117944585],
];

for (const [seed, integers, real] of NUMPY) {
  test(`the seed ${seed} draws what NumPy draws`, () => {
    const random = new Generator(seed);
    assert.deepEqual(
      [3, 1, 10, 1000, 7].map((count) => random.integer(count)),
      integers,
    );
    assert.equal(random.random(), real);
  });
}

test("a restored place draws the same numbers again", () => {
  const random = new Generator(3);
  random.integer(5); // Half of 64 bits is left.
  const { place } = random;
  const drawn = [random.integer(1000), random.random()];
  random.restore(place);
  assert.deepEqual([random.integer(1000), random.random()], drawn);
});
