// The list of keys and gestures.
const HAND_GESTURES = [
  ["Mouse", [
    ["Drag along sides", "build walls, or remove them; a click changes the wall at one side"],
    ["Drag over cells", "paint with the tool"],
    ["Shift + drag", "paint a rectangle"],
    ["Right button", "erase"],
    ["Alt + click", "take the tool of what is there"],
    ["Ctrl + wheel", "zoom"],
  ]],
  ["Touch", [
    ["One finger", "draw with the tool"],
    ["Two fingers", "scroll and zoom"],
    ["Long press", "select what is there"],
  ]],
];

/** A dialog that lists all keys, and switches those of letters, digits and signs off. */
class Help {
  constructor(editor, dialog, keyboard) {
    const heading = created("h2", {}, "Keys and gestures");
    const box = created("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => (keyboard.hasShortcuts = box.checked));
    const close = created("button", { type: "button", className: "close", ariaLabel: "Close" }, "✕");
    close.addEventListener("click", () => dialog.close());
    const tools = TOOLS.map(({ key, title }) => [key, title]);
    const groups = [["Tools", tools], ...KEYS.map(({ title, keys }) => [title, keys]), ...HAND_GESTURES];
    dialog.ariaLabel = heading.textContent;
    dialog.append(heading, close, created("label", { className: "check" }, box, " Letters, digits and signs are shortcuts"),
      ...groups.map(([title, rows]) => created("section", {}, created("h3", {}, title), created("dl", {},
        ...rows.map(([keys, words]) => created("div", {}, created("dt", {}, keys), created("dd", {}, words)))))));
    editor.on("help", () => dialog.showModal());
  }
}

/** Return an HTML element with properties and children. */
function created(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}
