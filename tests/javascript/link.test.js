import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateRawSync, inflateRawSync } from "node:zlib";
import { checked } from "../../babyrobot_levels/render/static/checks.js";
import { COMMON } from "../../babyrobot_levels/render/static/common.js";
import { linkedLevel } from "../../babyrobot_levels/render/static/link.js";
import { checksum } from "../../babyrobot_levels/render/static/play.js";
import { corridor } from "./page.js";

const CODE = "brl1.6.Abc-_9";
const DICTIONARY = inflateRawSync(Buffer.from(COMMON.dictionary, "base64url"));

/** Return the fragment of a link to data. */
function linkTo(data, { code = CODE, sum = 0 } = {}) {
  const packed = deflateRawSync(JSON.stringify(data), { dictionary: DICTIONARY });
  const head = Buffer.alloc(4);
  head.writeUInt32BE((checksum(packed, checksum(Buffer.from(code))) ^ sum) >>> 0);
  const body = Buffer.concat([head, packed]).toString("base64url");
  return `#${code}~1.${body.length}.${body}`;
}

test("a link has the level", async () => {
  assert.deepEqual(await linkedLevel(linkTo(corridor())), corridor());
});

test("what mail programs do to a link changes nothing", async () => {
  const link = linkTo(corridor());
  const broken = `${link.slice(0, 60)}\n ${link.slice(60)}`.replace("brl", "BRL").replace("~", "%7E");
  assert.deepEqual(await linkedLevel(broken), corridor());
});

test("other fragments are no links", async () => {
  assert.equal(await linkedLevel("#facts"), null);
});

const REFUSED = {
  "contains only a share code": `#${CODE}`,
  "has version 2": linkTo(corridor(), { code: "brl2.6.Abc-_9" }),
  "its last 3 characters are missing": linkTo(corridor()).slice(0, -3),
  "its checksum is wrong": linkTo(corridor(), { sum: 1 }),
  "its content is not a level": linkTo([]),
  "larger than any level": linkTo(corridor({ description: "a".repeat(2 * COMMON.max_unpacked) })),
};

for (const [message, link] of Object.entries(REFUSED)) {
  test(`a link is refused that ${message}`, async () => {
    await assert.rejects(linkedLevel(link), { message: new RegExp(message) });
  });
}

// Changes of a level after which it is none.
const DEFECTS = {
  "no probabilities": { rows: [[0.5, 0, 0, 0, 0, 0]] },
  "a start outside": { starts: [3] },
  "a start at an end": { starts: [2] },
  "a seed that is no number": { seed: "-1" },
  "too many cells": { width: 101 },
  "no limit of steps": { max_steps: 0 },
  "a policy of another size": { policy: [2] },
  "values of another size": { returns: { best: 1, random: null, values: [2, 1] } },
  "a discount above one": { discount: 1.5 },
  "an unknown walker": { walker: "worst" },
  "a colour that is a script": { robot: ["red", "url(x)"] },
};

for (const [what, changes] of Object.entries(DEFECTS)) {
  test(`a level with ${what} is refused`, () => {
    assert.throws(() => checked({ ...corridor(), ...changes }), /not a level/);
  });
}
