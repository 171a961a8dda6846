// Who plays, and the episodes that have ended since the page was opened: one file to hand in.

import { byId, keepText, recallText, saveFile } from "./dom.js";
import { checksum, playOf, signed } from "./play.js";

const NAME_STORE = "babyrobot:player";
const MOST_KEPT = 1000;
const OWN_SEEDS = 1000000n; // As `scoring/grades.py` has it.

/** Episodes that have ended. What was undone and played to another end is the same one. */
const kept = new Map();

/** The name of the player, which stays on this device; empty if it is not known. */
const playerName = () => byId("who").value.trim();

/** Take the name from the address, or from this device. */
export function recallName() {
  const name = new URLSearchParams(location.search).get("player") ?? recallText(NAME_STORE);
  byId("who").value = (name ?? "").slice(0, 200);
  keepName();
}

export function keepName() {
  keepText(NAME_STORE, playerName());
}

/**
 * The seed of a new episode, after another one. Who tells a name has luck of their own.
 *
 * @param {string} before
 * @param {string} next
 */
export function seedAfter(before, next) {
  if (playerName() === "") return next;
  const first = BigInt(checksum(new TextEncoder().encode(playerName())));
  return BigInt(before) >= first && BigInt(before) < first + OWN_SEEDS ? next : String(first);
}

/** Keep an episode that has ended; return how many there are in the level. @param {Game} game */
export function keepPlay(game) {
  const play = playOf(game);
  if (play === null) return 0;
  kept.set(game.past, play);
  if (kept.size > MOST_KEPT) kept.delete(kept.keys().next().value);
  return playsOf(game).length;
}

/**
 * Return the episode as a line with the name of the player; null if the page has no plays.
 *
 * @param {Game} game
 * @returns {string | null}
 */
export function playLine(game) {
  const play = playOf(game);
  return play === null ? null : signedBy(playerName(), play);
}

const signedBy = (name, play) => signed({ ...play, player: name || null });

function playsOf(game) {
  return [...kept.values()].filter(({ digest }) => digest === playOf(game).digest);
}

/** Save the episodes of the level that have ended as a file, under the name of the player. @param {Game} game */
export function downloadPlays(game) {
  const name = playerName();
  const lines = playsOf(game).map((play) => signedBy(name, play));
  const words = name ? `${name} ${game.data.title}` : `${game.data.title} ${game.seed}`;
  saveFile(`${words.replace(/[^\p{L}\p{N}]+/gu, "-")}.brlplay`, lines.join(""), "application/x-ndjson");
}
