// The list of all keys and gestures.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { TOOLS } from "./tools.js";

/** The dialog that lists the keys and gestures. */
export class Help {
  constructor(editor, dialog, keyboard) {
    const shortcuts = dialog.querySelector("input");
    shortcuts.onchange = () => (keyboard.hasShortcuts = shortcuts.checked);
    const tools = { title: "Tools", keys: [...TOOLS, ...COMMON.modifiers].map(({ key, title }) => [key, title]) };
    dialog.querySelector(".help-groups").append(...[tools, ...COMMON.keys].map(helpGroup));
    editor.on("help", () => dialog.showModal());
  }
}

/** Return the keys of a group, each with what it does. */
function helpGroup({ title, keys }) {
  const rows = keys.map(([pressed, words]) =>
    html("div", {}, html("dt", {}, ...keyElements(pressed)), html("dd", {}, words)),
  );
  return html("section", {}, html("h3", {}, title), html("dl", {}, ...rows));
}

/** Return keys as they are shown, each in a frame. */
function keyElements(pressed) {
  const here = /Mac|iPad|iPhone/.test(navigator.platform) ? pressed.replaceAll("Ctrl", "\u2318") : pressed;
  return here.split(/( \+ |, | or )/).map((part, index) => (index % 2 === 1 ? part : html("kbd", {}, part)));
}
