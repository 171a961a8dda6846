// Plays: an episode as a line of a `.brlplay` file, which `babyrobot replay` verifies.

import { COMMON } from "./common.js";

/** Return the episode as a play; null if the page lacks the share code of its level. @param {Game} game */
export function playOf(game) {
  const { data, isTurning, seed, taken, total, end, hints, undone, watched, number } = game;
  const fact = (name) => data.facts.find(([each]) => each === name)?.[1] ?? null;
  const digest = fact("Digest");
  if (data.code === undefined || digest === null) return null;
  return {
    format: "babyrobot-levels play",
    format_version: 1,
    name: fact("Level"),
    digest,
    code: data.code,
    action_set: isTurning ? "turns" : "all",
    discount: data.discount ?? 1,
    max_steps: data.max_steps,
    seed,
    seed_kind: "page",
    start: "drawn",
    states: [...taken.map((step) => step.number), number],
    actions: taken.map((step) => step.action),
    rewards: taken.map((step) => step.reward),
    return: total,
    end: end === null ? "unfinished" : end === "time" ? "truncated" : "terminated",
    hints,
    undone,
    watched,
    made_by: COMMON.made_by,
  };
}

/** Return a play as a line with its checksum. */
export function signed(play) {
  const text = JSON.stringify(play).slice(0, -1);
  const sum = checksum(new TextEncoder().encode(text)).toString(16).padStart(8, "0");
  return `${text},"checksum":"${sum}"}\n`;
}

/**
 * Return the CRC-32 of bytes; `before` is that of the bytes before them.
 *
 * @param {Uint8Array} bytes
 * @param {number} [before]
 */
export function checksum(bytes, before = 0) {
  let rest = ~before;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; bit++) rest = (rest >>> 1) ^ (rest & 1 ? 0xedb88320 : 0);
  }
  return ~rest >>> 0;
}
