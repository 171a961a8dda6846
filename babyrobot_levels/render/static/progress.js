// What the visitor has reached: kept in the browser, for all levels by their digests.

import { byId, html, keepData, recalled, showStars } from "./dom.js";

export const STORE = "babyrobot:progress";

/** Return the progress in all levels; nothing if there is none, or no storage. @returns {Record<string, any>} */
export function storedProgress() {
  const found = recalled(STORE);
  return found !== null && typeof found === "object" && !Array.isArray(found) ? found : {};
}

/**
 * Show what the visitor has reached in a level, and return the function that keeps what an episode
 * has reached; its stars are null if they are unknown.
 *
 * @param {string} digest
 * @param {HTMLElement} line
 * @returns {(game: Game, stars: number | null) => void}
 */
export function reachedIn(digest, line) {
  let reached = storedProgress()[digest];
  if (reached?.solved === true) showReached(line, reached);
  else reached = null;
  return (game, stars) => {
    if (!game.isGood || game.watched > 0) return;
    reached = {
      solved: true,
      best: Math.max(game.total, Number.isFinite(reached?.best) ? reached.best : -Infinity),
      ...(stars !== null && { stars: Math.max(stars, reached?.stars ?? 0) }),
    };
    // The last one that was reached stands last.
    const { [digest]: _, ...others } = storedProgress();
    // Without storage, it is shown until the page is left.
    keepData(STORE, { ...others, [digest]: reached });
    showReached(line, reached);
  };
}

function showReached(line, { best, stars }) {
  line.hidden = false;
  const text = Number.isFinite(best) ? `Your best return: ${Number(best.toFixed(2))}` : "Solved";
  line.replaceChildren(text.replace("-", "\u2212"));
  if (![1, 2, 3].includes(stars)) return;
  const mark = html("span", { class: "stars", role: "img" });
  showStars(mark, stars);
  line.append(" ", mark);
}

/**
 * Have the card of a result lead on to another page after a good end, and keep what is reached.
 *
 * @param {HTMLAnchorElement | null} link
 * @param {string} words
 * @param {(game: Game) => void} keep
 */
export function goOn(link, words, keep) {
  const key = html("kbd", {}, "Enter");
  const onwards = html("a", { class: "button onwards", hidden: true }, `${words} `, key);
  if (link !== null) onwards.href = link.href;
  byId("result").querySelector(".quick").prepend(onwards);
  document.addEventListener("episodeend", (/** @type {any} */ { detail: game }) => {
    keep(game);
    onwards.hidden = link === null || !game.isGood || game.watched > 0;
  });
}
