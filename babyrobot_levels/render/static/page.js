// A page of its own: plays its level, or the one after the `#` of its address.

import { checked, LinkError, NOT_A_LEVEL } from "./checks.js";
import { byId, prose } from "./dom.js";
import { linkedLevel } from "./link.js";
import { factElements, showLevel } from "./player.js";
import { goOn, reachedIn } from "./progress.js";
import { starsOf } from "./result.js";

const OWN = JSON.parse(byId("data").textContent);

// Pages of several levels lead on, and keep what is reached.
const levels = document.querySelector(".levels");
let reach = null;
if (levels) goOn(levels.querySelector('[rel="next"]'), "Next level", (game) => reach(game, starsOf(game)));

/** Show a level with its texts; nothing changes if that fails. */
function showPage(data) {
  showLevel(data);
  document.title = data.title;
  for (const name of ["title", "description"]) byId(name).textContent = data[name];
  byId("facts").replaceChildren(...data.facts.flatMap(factElements));
  if (!levels) return;
  byId("progress").hidden = true;
  reach = reachedIn(data.facts.find(([name]) => name === "Digest")[1], byId("progress"));
}

/** Show the level of the address, or the page's own level if there is none or it is invalid. */
async function showAddressed() {
  const { hash } = location;
  let message = "";
  try {
    const linked = await linkedLevel(hash);
    if (hash !== location.hash) return; // Another level is being loaded.
    showPage(linked ?? checked(OWN));
  } catch (error) {
    if (hash !== location.hash) return;
    message = error instanceof LinkError ? error.message : NOT_A_LEVEL;
    showPage(OWN);
  }
  notify(message && `${message} The page shows its own level instead.`);
  document.body.classList.add("ready");
}

/** Show an error message; commands in it are between backticks. */
function notify(message) {
  byId("notice").replaceChildren(...prose(message));
  byId("notice").hidden = message === "";
}

addEventListener("hashchange", showAddressed);
showAddressed();
