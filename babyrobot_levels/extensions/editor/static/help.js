// The list of all keys and gestures.

import { html } from "../../../render/static/dom.js";
import { dialogElement } from "./dialogs.js";
import { tapped } from "./html.js";
import { KEYS } from "./keys.js";
import { MODIFIERS, toolButton } from "./rail.js";
import { TOOLS } from "./tools.js";

const HAND_GESTURES = [
  {
    title: "Mouse and touch",
    keys: [
      ["Drag along sides", "build or remove walls"],
      [tapped("Click at a side"), "build or remove a wall"],
      ["Drag over cells", "use the tool"],
      ["Drag start or exit", "move it, with any tool"],
      ["Drag at the rim", "change the size"],
    ],
  },
  {
    title: "Mouse",
    needsMouse: true,
    keys: [
      ["Shift + drag", "use the tool in a rectangle"],
      ["Right button", "erase"],
      ["Alt + click", "take the tool of what is there"],
      ["Ctrl + wheel", "zoom"],
      ["Escape", "give up what is being drawn"],
    ],
  },
  {
    title: "Touch",
    keys: [
      ["Two fingers", "scroll and zoom"],
      ["Long press", "select what is there"],
    ],
  },
];

/** A dialog that lists the keys and gestures, and a button that opens it. */
export class Help {
  constructor(editor, place, root, keyboard) {
    const shortcuts = html("input", {
      type: "checkbox",
      checked: keyboard.hasShortcuts,
      onchange: () => (keyboard.hasShortcuts = shortcuts.checked),
    });
    const tools = { title: "Tools", keys: [...TOOLS, ...MODIFIERS].map(({ key, title }) => [key, title]) };
    const dialog = dialogElement(
      "Keys and gestures",
      html("label", { class: "check" }, shortcuts, " Letters, digits and signs are shortcuts"),
      html(
        "div",
        { class: "help-groups" },
        ...HAND_GESTURES.map((group) => helpGroup(group)),
        ...[tools, ...KEYS].map((group) => helpGroup(group, keyElements)),
      ),
    );
    dialog.classList.add("help");
    root.append(dialog);
    place.append(
      toolButton({ title: "Keys and gestures (?)", named: "Keys", icon: HELP_ICON }, () => dialog.showModal()),
    );
    editor.on("help", () => dialog.showModal());
  }
}

const HELP_ICON =
  "M12 3a9 9 0 1 1 0 18a9 9 0 0 1 0-18zM9.5 9.5a2.5 2.5 0 1 1 3.600 2.200c-.7.4-1.100.9-1.100 1.800M12 16.500v.5";

/**
 * Return a group of the list; `shown` makes elements of the keys, else they are words.
 *
 * @param {{ title: string, keys: any[][], needsMouse?: boolean }} group
 * @param {(pressed: string) => (Node | string)[]} [shown]
 */
function helpGroup({ title, keys, needsMouse }, shown = (pressed) => [pressed]) {
  const rows = keys.map(([pressed, words]) =>
    html("div", {}, html("dt", {}, ...shown(pressed)), html("dd", {}, words)),
  );
  return html("section", { class: needsMouse && "with-mouse" }, html("h3", {}, title), html("dl", {}, ...rows));
}

/** Return keys as they are shown, each in a frame. */
function keyElements(pressed) {
  const here = /Mac|iPad|iPhone/.test(navigator.platform) ? pressed.replaceAll("Ctrl", "\u2318") : pressed;
  return here.split(/( \+ |, | or )/).map((part, index) => (index % 2 === 1 ? part : html("kbd", {}, part)));
}
