// The list of all keys and gestures.
const HAND_GESTURES = [
  { title: "Mouse", keys: [
    ["Drag along sides", "build or remove walls"],
    ["Click at a side", "none, wall, glass, door, one after the other"],
    ["Drag over cells", "use the tool"],
    ["Drag start or exit", "move it, with any tool"],
    ["Drag at the rim", "change the size"],
    ["Shift + drag", "use the tool in a rectangle"],
    ["Right button", "erase"],
    ["Alt + click", "take the tool of what is there"],
    ["Ctrl + wheel", "zoom"],
    ["Escape", "give up what is being drawn"],
  ] },
  { title: "Touch", keys: [
    ["One finger", "draw as with the mouse"],
    ["Two fingers", "scroll and zoom"],
    ["Long press", "select what is there"],
  ] },
];

/** A dialog that lists the keys and gestures, and turns those of letters, digits and signs off. */
class Help {
  constructor(editor, dialog, keyboard) {
    const shortcuts = html("input", {
      type: "checkbox",
      checked: keyboard.hasShortcuts,
      onchange: () => (keyboard.hasShortcuts = shortcuts.checked),
    });
    const tools = { title: "Tools", keys: TOOLS.map(({ key, title }) => [key, title]) };
    dialog.append(
      html("h2", { id: "help-title" }, "Keys and gestures"),
      button("✕", { class: "close", "aria-label": "Close", onclick: () => dialog.close() }),
      html("label", { class: "check" }, shortcuts, " Letters, digits and signs are shortcuts"),
      html("div", { class: "help-groups" }, ...[tools, ...KEYS, ...HAND_GESTURES].map(helpGroup)),
    );
    dialog.setAttribute("aria-labelledby", "help-title");
    editor.on("help", () => dialog.showModal());
  }
}

function helpGroup({ title, keys }) {
  const rows = keys.map(([pressed, words]) => html("div", {}, html("dt", {}, pressed), html("dd", {}, words)));
  return html("section", {}, html("h3", {}, title), html("dl", {}, ...rows));
}
