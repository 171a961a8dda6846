// The page of a level: tabs, texts to copy, and what the visitor has reached.

import { byId, copyText } from "../../../render/static/dom.js";
import { reachedIn } from "../../../render/static/progress.js";
import { listenToArrows, markChosen } from "../../../render/static/steps.js";

const COPIED = 2000; // Milliseconds for which a button says so.
const level = byId("level");

// -- tabs ----------------------------------------------------------------------------------

const tabList = byId("tabs");
const tabs = [...tabList.children];
const panelOf = (tab) => byId(tab.getAttribute("aria-controls"));
const nameOf = (tab) => tab.id.replace("tab-", "");
const isOfGame = (tab) => nameOf(tab) === "play";

/** Begins the game; null without one, and once it has begun. */
let beginGame = null;

/** Have the game begun when it is seen first: its picture is laid out for the room that it has. */
export function playWhenSeen(begin) {
  beginGame = begin;
  beginIfSeen();
}

function beginIfSeen() {
  const begin = beginGame;
  if (begin === null || !tabs.some((tab) => isOfGame(tab) && !panelOf(tab).hidden)) return;
  beginGame = null;
  document.body.classList.add("ready");
  begin();
}

function chooseTab(tab) {
  markChosen(tabs, tab);
  for (const each of tabs) panelOf(each).hidden = each !== tab;
  tab.scrollIntoView?.({ block: "nearest", inline: "nearest" });
  beginIfSeen();
}

/** Show a tab that the visitor chose; the address leads to it. */
function open(tab) {
  chooseTab(tab);
  history.replaceState(null, "", `#${nameOf(tab)}`);
}

function openAddressed() {
  chooseTab(tabs.find((tab) => `#${nameOf(tab)}` === location.hash) ?? tabs[0]);
}

for (const tab of tabs) {
  const panel = panelOf(tab);
  panel.setAttribute("role", "tabpanel");
  panel.setAttribute("aria-labelledby", tab.id);
  tab.addEventListener("click", ({ detail }) => {
    open(tab);
    // Whoever points at the game plays next: its keys are not those of tabs.
    if (isOfGame(tab) && detail > 0) byId("stage")?.focus({ preventScroll: true });
  });
}
listenToArrows(tabList, open);

// -- texts to copy -------------------------------------------------------------------------

async function copy(text, button) {
  await copyText(text, button);
  const [label] = button.childNodes;
  const before = (button.dataset.label ??= label.data);
  label.data = "Copied";
  byId("copied").textContent = "Copied.";
  setTimeout(() => {
    label.data = before;
    byId("copied").textContent = "";
  }, COPIED);
}

for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", () => copy(byId(button.dataset.copy).textContent, button));
}
byId("copy-link").addEventListener("click", ({ target }) => copy(location.href, target));
for (const each of document.querySelectorAll(".with-script")) each.hidden = false;
// A file has an address of its own on each computer.
byId("copy-link").parentElement.hidden = location.protocol === "file:";

// -- for what is held the values are -------------------------------------------------------

for (const sets of document.querySelectorAll("#panel-values .sets")) {
  const show = () => {
    const chosen = sets.querySelector(":checked").getAttribute("value");
    for (const image of sets.parentElement.querySelectorAll("img")) image.hidden = image.getAttribute("src") !== chosen;
  };
  sets.addEventListener("change", show);
  show();
}

// -- what the visitor has reached ----------------------------------------------------------

export const reach = reachedIn(level.dataset.digest, byId("progress"));

tabList.hidden = false;
level.classList.add("tabbed");
addEventListener("hashchange", openAddressed);
openAddressed();
