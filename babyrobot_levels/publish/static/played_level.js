// The page of a level that can be played.

import { checked } from "../../render/static/checks.js";
import { byId } from "../../render/static/dom.js";
import { showLevel } from "../../render/static/player.js";
import { starsOf } from "../../render/static/result.js";
import { playWhenSeen, reach } from "./level.js";

/** @type {HTMLAnchorElement | null} */
const following = document.querySelector('a[rel="next"]');
const onwards = document.createElement("a");
if (following) {
  Object.assign(onwards, {
    className: "button onwards",
    href: following.href,
    textContent: "Next level",
    hidden: true,
  });
  byId("result").querySelector(".quick").prepend(onwards);
}

document.addEventListener("episodeend", (/** @type {any} */ { detail: game }) => {
  reach(game, starsOf(game));
  onwards.hidden = !game.isGood || game.watched > 0;
});
playWhenSeen(() => showLevel(checked(JSON.parse(byId("data").textContent))));
