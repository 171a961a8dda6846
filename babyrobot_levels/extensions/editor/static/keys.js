// The keyboard. One table says which keys there are and what they do; the help lists it.

import { ZOOM_STEP } from "../../../render/static/view.js";
import { cellName, SIDE_NAMES } from "./announce.js";
import { MODIFIERS } from "./rail.js";
import { copy, MIRRORS, mirror } from "./region.js";
import { beyond, isSameCell, spotOf } from "./spots.js";
import { drawnWalls, gestureOf, sizeOf, TOOLS, toolNamed, wallAt } from "./tools.js";

const ARROWS = { ArrowUp: "N", ArrowRight: "E", ArrowDown: "S", ArrowLeft: "W" };

/** Return an action for each arrow together with the keys that are held; it gets the side. */
function arrows(held, action) {
  return Object.fromEntries(
    Object.entries(ARROWS).map(([arrow, side]) => [[...held, arrow].join("+"), (keyboard) => action(keyboard, side)]),
  );
}

/** Return an action for each of some keys. */
function on(keys, action) {
  return Object.fromEntries(keys.split(" ").map((key) => [key, action]));
}

/** Return the name of a pressed key, such as "Ctrl+Shift+Z". Signs are named without Shift. */
function keyOf({ key, ctrlKey, metaKey, altKey, shiftKey }) {
  const isSign = key.length === 1 && key !== " " && key.toLowerCase() === key.toUpperCase();
  const name = key === " " ? "Space" : key.length === 1 ? key.toUpperCase() : key;
  const held = [
    [ctrlKey || metaKey, "Ctrl"],
    [altKey, "Alt"],
    [shiftKey && !isSign, "Shift"],
  ];
  return [...held.filter(([isHeld]) => isHeld).map(([, word]) => word), name].join("+");
}

/**
 * The keys, in groups: `[keys as they are shown, what they do, actions by key]`.
 *
 * Those of a group with a `mode` do something in that mode alone, and while neither a text nor a
 * dialog has the focus.
 */
export const KEYS = [
  {
    title: "Cursor",
    mode: "edit",
    keys: [
      ["← ↑ → ↓", "move the cursor", arrows([], (keyboard, side) => keyboard.move(side))],
      ["Ctrl + arrow", "move it to the next wall", arrows(["Ctrl"], (keyboard, side) => keyboard.run(side))],
      [
        "Home, End, Page up, Page down",
        "move it to the end of the row or column",
        {
          Home: (keyboard) => keyboard.jump(0, null),
          End: (keyboard) => keyboard.jump(Infinity, null),
          PageUp: (keyboard) => keyboard.jump(null, 0),
          PageDown: (keyboard) => keyboard.jump(null, Infinity),
        },
      ],
      ["L", "tell what is in the cell and at its sides", { L: ({ editor }) => editor.tell("look") }],
      ["I", "select what is in the cell, and go to its fields", { I: (keyboard) => keyboard.inspect() }],
    ],
  },
  {
    title: "Drawing",
    mode: "edit",
    keys: [
      ["Space, Enter", "use the tool in the cell", on("Space Enter", (keyboard) => keyboard.use())],
      [
        "Shift + arrow",
        "build or remove a wall at that side, or glass or a door with its tool; with the tool of wind, blow to it",
        arrows(["Shift"], (keyboard, side) => keyboard.useAtSide(side)),
      ],
      [
        "M",
        "begin to drag here; Space ends at the cursor, Shift + arrow ends a run of walls",
        { M: (keyboard) => keyboard.hold() },
      ],
      [
        "Shift + Space",
        "use the tool in the rectangle between where the drag began and the cursor",
        { "Shift+Space": (keyboard) => keyboard.useStraight({ rectangle: true }) },
      ],
      ["Delete", "erase the cell, or remove what is selected", on("Delete Backspace", (keyboard) => keyboard.erase())],
      [
        "Ctrl + C",
        "copy what is selected, or the cell; C, M and Space copy a rectangle",
        { "Ctrl+C": (keyboard) => keyboard.copy() },
      ],
      ["Ctrl + V", "stamp what is copied", { "Ctrl+V": (keyboard) => keyboard.stamp() }],
      [
        "H, Y",
        "mirror what is copied",
        Object.fromEntries(MIRRORS.map(({ axis, key }) => [key, ({ editor }) => mirror(editor, axis)])),
      ],
      ["Escape", "end a drag without a change; select nothing", { Escape: (keyboard) => keyboard.cancel() }],
    ],
  },
  {
    title: "Level",
    mode: "edit",
    keys: [
      [
        "Alt + arrow",
        "add a column or row at that side",
        arrows(["Alt"], (keyboard, side) => keyboard.resize(side, 1)),
      ],
      [
        "Alt + Shift + arrow",
        "remove the column or row at that side",
        arrows(["Alt", "Shift"], (keyboard, side) => keyboard.resize(side, -1)),
      ],
    ],
  },
  {
    title: "Playing",
    mode: "play",
    keys: [
      [
        "← ↑ → ↓ or W A S D",
        "move the robot",
        {
          ...arrows([], ({ editor }, side) => editor.playing.go(side)),
          ...Object.fromEntries([..."WDSA"].map((key, at) => [key, ({ editor }) => editor.playing.go("NESW"[at])])),
        },
      ],
      ["Space", "stay", { Space: ({ editor }) => editor.playing.take(0) }],
      ["Z", "undo an action", { Z: ({ editor }) => editor.playing.undo() }],
      ["R", "retry with the same luck", { R: ({ editor }) => editor.playing.begin() }],
      ["N", "take new luck", { N: ({ editor }) => editor.playing.newLuck() }],
      ["Escape", "edit again", { Escape: ({ editor }) => editor.set("mode", { mode: "edit" }) }],
    ],
  },
  {
    title: "Policy",
    mode: "policy",
    keys: [
      ["← ↑ → ↓", "move the cursor", arrows([], (keyboard, side) => keyboard.move(side))],
      [
        "Shift + arrow",
        "draw an arrow in the cell, and go on",
        arrows(["Shift"], ({ editor }, side) => editor.policy.step(side)),
      ],
      [
        "Space, Enter",
        "give the cell the next action",
        on("Space Enter", ({ editor }) => editor.policy.turn(editor.cursor.cell)),
      ],
      ["Delete", "clear the cell", on("Delete Backspace", ({ editor }) => editor.policy.erase(editor.cursor.cell))],
      ["Escape", "edit again", { Escape: ({ editor }) => editor.set("mode", { mode: "edit" }) }],
    ],
  },
  {
    title: "Learning",
    mode: "edit",
    keys: [
      ["Q", "run or stop what learns, in its panel", { Q: ({ editor }) => editor.learning.command("run") }],
      [".", "learn from one step, or one state of a sweep", { ".": ({ editor }) => editor.learning.command("step") }],
      ["U", "learn to the end of the episode or the sweep", { U: ({ editor }) => editor.learning.command("unit") }],
    ],
  },
  {
    title: "Answers and modes",
    keys: [
      ["V", "show the values, or no longer", { V: ({ editor }) => editor.answers.toggle("values") }],
      ["B", "show the optimal actions, or no longer", { B: ({ editor }) => editor.answers.toggle("policy") }],
      ["P", "play the level, or edit it again", { P: ({ editor }) => editor.playing.toggle() }],
    ],
  },
  {
    title: "Anywhere",
    keys: [
      ["Ctrl + Z", "undo", { "Ctrl+Z": ({ editor }) => editor.send({ do: "undo" }) }],
      ["Ctrl + Y, Ctrl + Shift + Z", "redo", on("Ctrl+Y Ctrl+Shift+Z", ({ editor }) => editor.send({ do: "redo" }))],
      [
        "+ − 0",
        "zoom in, zoom out, show the whole level",
        {
          "+": (keyboard) => keyboard.zoomBy(ZOOM_STEP),
          "=": (keyboard) => keyboard.zoomBy(ZOOM_STEP),
          "-": (keyboard) => keyboard.zoomBy(1 / ZOOM_STEP),
          0: (keyboard) => keyboard.zoomBy(0),
        },
      ],
      ["Ctrl + S", "save", { "Ctrl+S": ({ editor }) => editor.tell("save") }],
      [
        "F6, Shift + F6",
        "go to the next or previous part of the editor",
        {
          F6: (keyboard) => keyboard.goOn(1),
          "Shift+F6": (keyboard) => keyboard.goOn(-1),
        },
      ],
      ["?, F1", "list the keys and gestures", on("? F1", ({ editor }) => editor.tell("help"))],
    ],
  },
  // The text area itself does these.
  {
    title: "Text",
    keys: [
      ["Tab", "insert two spaces", {}],
      ["Escape, Tab", "go to the next control", {}],
    ],
  },
];

/** The keys of one editor. */
export class KeyBindings {
  constructor(editor, root, overlay) {
    this.editor = editor;
    this.root = root;
    this.stage = root.querySelector(".stage");
    this.pointer = editor.pointer;
    this.overlay = overlay;
    this.hasShortcuts = true; // Whether letters, digits and signs do something.
    this.start = null; // The cell in which the last drag began.
    root.addEventListener("keydown", (event) => this.press(event));
    root.addEventListener("click", (event) => this.giveBack(event));
    editor.on("state", () => this.stayInside());
  }

  press(event) {
    const { target } = event;
    if (event.defaultPrevented || target.closest("dialog")) return;
    const key = keyOf(event);
    const isText = target.matches("textarea, select, input:not([type=checkbox])");
    if (isText && !/^((Shift\+)?F\d+|Ctrl\+S)$/.test(key)) return;
    if (key.length === 1 && !this.hasShortcuts) return;
    if (/^(Space|Enter)$/.test(key) && target !== this.stage) return;
    const action = this.actionOf(key, target.closest(".stage, .playing, .policy") !== null);
    if (action === undefined) return;
    event.preventDefault();
    action(this);
  }

  /** Give the keys back to the picture after a pointer has pressed a button beside it. */
  giveBack({ target, detail }) {
    const pressed = target.closest(BESIDE_PICTURE);
    const { activeElement } = this.root;
    if (detail > 0 && pressed !== null && (activeElement === pressed || activeElement === null)) {
      this.stage.focus({ preventScroll: true });
    }
  }

  /** Return what a key does now, or undefined. Keys with longer names do it in the picture alone. */
  actionOf(key, isStage) {
    const current = this.editor.game ? this.editor.mode : null; // Without a picture none works.
    const chosen = [...TOOLS, ...MODIFIERS].find((each) => each.key === key);
    if (chosen !== undefined && current === "edit") return () => this.choose(chosen);
    return KEYS.filter(({ mode }) => mode === undefined || (mode === current && (isStage || key.length === 1)))
      .flatMap(({ keys }) => keys)
      .map(([, , actions]) => actions[key])
      .find((action) => action !== undefined);
  }

  get cell() {
    return this.editor.cursor.cell;
  }

  goTo(cell) {
    if (this.isDragging) this.pointer.drag(spotOf(cell));
    this.editor.set("cursor", { cursor: { cell, side: null } });
    this.reveal();
  }

  /** Scroll so that the cursor is seen. */
  reveal() {
    this.stage.querySelector(".layers > .cursor")?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  zoomBy(factor) {
    if (!this.editor.game) return;
    const { view } = this.editor.stage;
    view.zoomBy(factor);
    this.reveal();
  }

  /** Keep the cursor inside a level that became smaller. */
  stayInside() {
    if (!this.editor.game) return;
    const inside = this.within(this.cell);
    if (!isSameCell(inside, this.cell)) this.goTo(inside);
  }

  /** Return the nearest cell of the level. */
  within(cell) {
    const size = sizeOf(this.editor);
    return cell.map((place, axis) => Math.min(size[axis] - 1, Math.max(0, place)));
  }

  move(side) {
    const cell = beyond(this.cell, side);
    if (isSameCell(cell, this.within(cell))) this.goTo(cell);
    else this.editor.say(`${cellName(this.cell)} is at the ${SIDE_NAMES[side]} edge.`);
  }

  run(side) {
    let cell = this.cell;
    while (wallAt(this.editor, cell, side) === null) cell = beyond(cell, side);
    this.goTo(cell);
  }

  jump(x, y) {
    this.goTo(this.within([x ?? this.cell[0], y ?? this.cell[1]]));
  }

  /** Select what is in the cell, and focus the first of its fields. */
  inspect() {
    this.editor.set("panel", { panel: "inspector" });
    this.pointer.selectAt(spotOf(this.cell));
    this.root.querySelector(".inspector").querySelector(FOCUSABLE)?.focus();
  }

  /** Choose a tool, or switch what changes the tools on or off. */
  choose(chosen) {
    const { editor } = this;
    if (TOOLS.includes(chosen)) editor.choose(chosen.name);
    else editor.toggle(chosen.name);
    editor.say(`${chosen.title}${editor.modifiers[chosen.name] === false ? " off" : ""}.`);
  }

  /** Begin a drag, which the cursor's ways continue. */
  hold() {
    this.start = this.cell;
    this.pointer.pressTool(spotOf(this.cell));
    this.editor.say(`A drag begins at ${cellName(this.cell)}.`);
  }

  get isDragging() {
    return this.pointer.spots !== null;
  }

  /** Use the tool as a click does, or end a drag. */
  use() {
    if (!this.isDragging) this.pointer.pressTool(spotOf(this.cell));
    this.pointer.release();
  }

  /** Use the tool straight from where the drag began to the cursor. */
  useStraight(modifiers) {
    this.useBetween(null, (spots) => gestureOf(this.editor, spots, modifiers));
  }

  /** Draw along a side of the cells from where the drag began to the cursor, or blow to it. */
  useAtSide(side) {
    const { editor, overlay } = this;
    if (editor.tool !== "wind") {
      const tool = toolNamed(editor.tool);
      this.useBetween(side, (spots) => drawnWalls(editor, tool.builds ? tool : toolNamed("walls"), spots));
      return;
    }
    const index = this.cell["NS".includes(side) ? 0 : 1];
    editor.send(overlay.gestureOf({ dataset: { handle: "wind", side, index } })());
  }

  useBetween(side, messageOf) {
    const first = this.isDragging ? this.start : this.cell;
    this.pointer.cancel();
    this.pointer.press(spotOf(first, side), messageOf);
    this.pointer.drag(spotOf(this.cell, side));
    this.pointer.release();
  }

  erase() {
    if (this.editor.selection !== null) this.editor.removeSelected();
    else this.useStraight({ erases: true });
  }

  /** Copy the cells of what is selected, or that of the cursor. */
  copy() {
    const { cells = [] } = this.editor.selection ?? {};
    copy(this.editor, cells.length > 0 ? cells : [this.cell]);
  }

  /** Stamp what is copied where the cursor is; the pointer is shown what it would stamp. */
  stamp() {
    const { editor, pointer } = this;
    if (editor.region === null) {
      editor.say("Nothing is copied yet: drag over some cells first.");
      return;
    }
    editor.choose("stamp");
    if (editor.pointed === null) pointer.pressTool(spotOf(this.cell));
    if (editor.pointed === null) pointer.release();
    else pointer.hover(spotOf(editor.pointed));
  }

  cancel() {
    const { editor, pointer } = this;
    if (!this.isDragging && editor.tool === "stamp") editor.region = null;
    if (!this.isDragging) editor.select(null);
    else editor.say("Cancelled: nothing has changed.");
    pointer.cancel();
  }

  /** Add columns or rows at a side of the level; negative numbers remove them. */
  resize(side, count) {
    const [columns, rows] = sizeOf(this.editor);
    const size = "NS".includes(side) ? [columns, rows + count] : [columns + count, rows];
    const shift = { N: [0, count], W: [count, 0] }[side] ?? [0, 0];
    this.editor.send({ do: "resize", size, shift });
  }

  /** Focus the first control of the next part of the editor, or of one before. */
  goOn(step) {
    const parts = [...this.root.querySelectorAll("[data-part]:not([inert])")];
    const at = parts.findIndex((part) => part.contains(this.root.activeElement));
    const part = parts.at((at + step) % parts.length);
    const controls = [part, ...part.querySelectorAll(FOCUSABLE)].filter((each) => each.matches(FOCUSABLE));
    controls.find((each) => each.getClientRects().length > 0)?.focus();
  }
}

const BESIDE_PICTURE = ["bar", "tools", "board", "answers", "tabs", "steps", "algorithm"]
  .map((name) => `.${name} button`)
  .join();
const FOCUSABLE = "button:not(:disabled), input:not(:disabled), textarea, select, summary, [tabindex='0']";
