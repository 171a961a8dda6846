// The keyboard: what keys do in the editor.

import { COMMON } from "../../../render/static/common.js";
import { ZOOM_STEP } from "../../../render/static/view.js";
import { cellName } from "./announce.js";
import { copy, MIRRORS, mirror } from "./region.js";
import { beyond, isSameCell, SIDE_NAMES, spotOf } from "./spots.js";
import { drawnWalls, gestureOf, selectAt, sizeOf, TOOLS, toolNamed, wallAt } from "./tools.js";

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
 * What keys do in each mode, while neither a text nor a dialog has the focus; and in any. What is said of them is
 * in `keys.json`. The text area itself has others.
 */
export const ACTIONS = {
  edit: {
    ...arrows([], (keyboard, side) => keyboard.move(side)),
    ...arrows(["Ctrl"], (keyboard, side) => keyboard.run(side)),
    Home: (keyboard) => keyboard.jump(0, null),
    End: (keyboard) => keyboard.jump(Infinity, null),
    PageUp: (keyboard) => keyboard.jump(null, 0),
    PageDown: (keyboard) => keyboard.jump(null, Infinity),
    L: ({ editor }) => editor.tell("look"),
    I: (keyboard) => keyboard.inspect(),
    ...on("Space Enter", (keyboard) => keyboard.use()),
    ...arrows(["Shift"], (keyboard, side) => keyboard.useAtSide(side)),
    M: (keyboard) => keyboard.hold(),
    "Shift+Space": (keyboard) => keyboard.useStraight({ rectangle: true }),
    ...on("Delete Backspace", (keyboard) => keyboard.erase()),
    "Ctrl+C": (keyboard) => keyboard.copy(),
    "Ctrl+V": (keyboard) => keyboard.stamp(),
    ...Object.fromEntries(MIRRORS.map(({ axis, key }) => [key, ({ editor }) => mirror(editor, axis)])),
    Escape: (keyboard) => keyboard.cancel(),
    ...arrows(["Alt"], (keyboard, side) => keyboard.resize(side, 1)),
    ...arrows(["Alt", "Shift"], (keyboard, side) => keyboard.resize(side, -1)),
    Q: ({ editor }) => editor.learning.command("run"),
    ".": ({ editor }) => editor.learning.command("step"),
    U: ({ editor }) => editor.learning.command("unit"),
  },
  play: {
    ...arrows([], ({ editor }, side) => editor.playing.go(side)),
    ...Object.fromEntries([..."WDSA"].map((key, at) => [key, ({ editor }) => editor.playing.go("NESW"[at])])),
    Space: ({ editor }) => editor.playing.take(0),
    Z: ({ editor }) => editor.playing.undo(),
    R: ({ editor }) => editor.playing.begin(),
    N: ({ editor }) => editor.playing.newLuck(),
    Escape: ({ editor }) => editor.set("mode", { mode: "edit" }),
  },
  policy: {
    ...arrows([], (keyboard, side) => keyboard.move(side)),
    ...arrows(["Shift"], ({ editor }, side) => editor.policy.step(side)),
    ...on("Space Enter", ({ editor }) => editor.policy.turn(editor.cursor.cell)),
    ...on("Delete Backspace", ({ editor }) => editor.policy.erase(editor.cursor.cell)),
    Escape: ({ editor }) => editor.set("mode", { mode: "edit" }),
  },
  any: {
    V: ({ editor }) => editor.answers.toggle("values"),
    B: ({ editor }) => editor.answers.toggle("policy"),
    P: ({ editor }) => editor.playing.toggle(),
    "Ctrl+Z": ({ editor }) => editor.send({ do: "undo" }),
    ...on("Ctrl+Y Ctrl+Shift+Z", ({ editor }) => editor.send({ do: "redo" })),
    ...on("+ =", (keyboard) => keyboard.zoomBy(ZOOM_STEP)),
    "-": (keyboard) => keyboard.zoomBy(1 / ZOOM_STEP),
    0: (keyboard) => keyboard.zoomBy(0),
    "Ctrl+S": ({ editor }) => editor.tell("save"),
    F6: (keyboard) => keyboard.goOn(1),
    "Shift+F6": (keyboard) => keyboard.goOn(-1),
    ...on("? F1", ({ editor }) => editor.tell("help")),
  },
};

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
    const chosen = [...TOOLS, ...COMMON.modifiers].find((each) => each.key === key);
    if (chosen !== undefined && current === "edit") return () => this.choose(chosen);
    return (isStage || key.length === 1 ? ACTIONS[current]?.[key] : undefined) ?? ACTIONS.any[key];
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
    selectAt(this.editor, spotOf(this.cell));
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
