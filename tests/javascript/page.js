// A page without a browser: what all levels share, for the modules that read it as they are loaded,
// and a level to play. Node loads this before each test.

import { readFileSync } from "node:fs";
import { deflateRawSync } from "node:zlib";

/** Return data that Python gives to the editor. */
export function editorData(name) {
  return JSON.parse(
    readFileSync(`${import.meta.dirname}/../../babyrobot_levels/extensions/editor/static/${name}`, "utf8"),
  );
}

const COMMON = {
  ...editorData("tools.json"),
  cell: 40,
  events: ["stay", "move", "carried", "bump", "skid", "bounce"],
  cheer: 9,
  phases: 4,
  max_cells: 100,
  max_states: 1000,
  headings: [
    [1, 2, 3, 4],
    [5, 6, 7, 8],
  ],
  needed: { item: "held", switch: "on" },
  spots: [],
  robot: ["#000000", "#ffffff", "#888888"],
  palette: [],
  shapes: [],
  sprites: Array.from({ length: 10 }, () => []),
  made_by: "a test",
  code_versions: [1],
  play_versions: [1],
  max_unpacked: 4000,
  dictionary: deflateRawSync('{"title":"').toString("base64url"),
};

const elements = { common: { textContent: JSON.stringify(COMMON) } };
globalThis.document = { getElementById: (name) => elements[name] };

/**
 * Return a corridor of three cells with the exit in the east. In the middle, a move to the east skids
 * half of the time, and the robot stays.
 */
export function corridor(changes = {}) {
  const [stay, east, west, bump] = [
    [0, 0],
    [1, 1],
    [-1, 1],
    [0, 3],
  ].map(([shift, event]) => [1, shift, -1, 0, event, 0]);
  const toExit = [0.5, 1, 10, 1, 1, 0, 0.5, 0, -1, 0, 4, 0];
  return {
    title: "Corridor",
    description: "",
    facts: [
      ["Level", "corridor"],
      ["Digest", "abc"],
    ],
    width: 3,
    height: 1,
    margin: 5,
    speed: 1,
    starts: [0],
    exits: [2],
    max_steps: 4,
    rows: [stay, east, west, bump, toExit],
    table: [0, 3, 1, 3, 3, 0, 3, 4, 3, 2, -1, -1, -1, -1, -1],
    possible: [0b00101, 0b10101, 0],
    robot: ["#000000", "#ffffff"],
    picture: { width: 130, height: 50, layers: {}, palette: [] },
    seed: "7",
    walker: "best",
    shown: [],
    policy: [2, 2, -1],
    best: "8.00",
    returns: { best: 8, random: 2 },
    code: "brl1.6.Abc-_9",
    ...changes,
  };
}
