// In place of `team.js` in pages of one robot, which have less to load.

import { LinkError } from "./checks.js";
import { Game } from "./game.js";

/** The game of a level. */
export function gameOf(data) {
  if (data.robots !== undefined)
    throw new LinkError("This link is to a level with several robots; play it on its own page.");
  return new Game(data, data.turns?.on ?? false);
}

/** Nobody chooses which robots to move. */
export class Hands {
  begin() {}
}
