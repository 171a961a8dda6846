// The page of a level that can be played.

import { checked } from "../../../render/static/checks.js";
import { byId } from "../../../render/static/dom.js";
import { learnAddressed, showLevel } from "../../../render/static/player.js";
import { goOn } from "../../../render/static/progress.js";
import { starsOf } from "../../../render/static/result.js";
import { playWhenSeen, reach } from "./level.js";

/** @type {any} */
const [all, following] = document.querySelectorAll('.bar > a, a[rel="next"]');
goOn(following ?? all, following ? "Next level" : "All levels", (game) => reach(game, starsOf(game)));
playWhenSeen(() => {
  showLevel(checked(JSON.parse(byId("data").textContent)));
  addEventListener("hashchange", learnAddressed);
});
