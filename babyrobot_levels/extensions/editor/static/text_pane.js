// The text of the level: typed, and marked where findings and what is selected are.

import { COMMON } from "../../../render/static/common.js";
import { prose } from "../../../render/static/dom.js";
import { finder } from "./html.js";
import { lineElement, markOf, plainLines } from "./yaml_lines.js";

const TYPING_PAUSE = 150; // Milliseconds after which what was typed is sent.
const TYPING_STEP = 1000; // Milliseconds without typing between two steps to undo.
const MOST_COLORED = 60000; // Characters of a text that is coloured.
const TEXT_INDENT = "  ";

/**
 * A text area without a colour of its own, over a mirror of its lines that has the colours and
 * marks. Both are as large as the text; what is around them scrolls.
 */
export class TextPane {
  constructor(editor, place) {
    this.editor = editor;
    this.shown = []; // What each line of the mirror was made of.
    this.timer = null;
    this.sending = 0;
    this.typedAt = 0;
    this.isJoined = false;
    this.revision = null; // That which came of what was typed last.
    this.leaves = false; // Whether Tab leaves the area, as it does after Escape.
    place.innerHTML = COMMON.text;
    const find = finder(place);
    this.note = find(".at-caret");
    this.mirror = find(".mirror");
    this.area = find(".text");
    this.pane = find(".pane");
    editor.on("state", () => this.show());
    editor.on("selection", () => {
      this.paint(false);
      this.choose();
    });
    editor.on("caret", () => this.goTo(editor.caret));
    this.listen();
  }

  listen() {
    const { area } = this;
    area.addEventListener("input", () => this.typed());
    area.addEventListener("blur", () => this.flush());
    area.addEventListener("keydown", (event) => this.press(event));
    area.addEventListener("beforeinput", (event) => {
      const asked = { historyUndo: "undo", historyRedo: "redo" }[event.inputType];
      if (asked === undefined) return;
      event.preventDefault();
      this.ask(asked);
    });
    for (const name of ["keyup", "click"]) area.addEventListener(name, () => this.showCaret());
    area.addEventListener("pointermove", ({ clientX, clientY }) => {
      const below = area.getRootNode().elementsFromPoint(clientX, clientY);
      const line = below.find((each) => each.classList.contains("line"));
      const number = line === undefined ? 0 : [...this.mirror.children].indexOf(line) + 1;
      area.title = this.findingsAt(number)
        .map(({ message }) => message)
        .join("\n");
    });
  }

  // -- the state ---------------------------------------------------------------------------------

  show() {
    if (this.timer !== null || this.sending > 0) return; // What is typed is newer.
    const { text: changed } = this.editor.state;
    if (this.area.value !== changed) this.replace(changed);
    this.paint(true);
    this.choose(false);
    this.tellFinding();
  }

  /** What is selected. Its lines are those of the last valid text, so an invalid one has none. */
  get selection() {
    return this.editor.state?.is_valid ? this.editor.selection : null;
  }

  /** Show another text; the caret stays where it is in what is the same. */
  replace(changed) {
    const { area } = this;
    const { value } = area;
    const [first, same] = sameEnds(value, changed);
    const last = changed.length - same;
    area.setRangeText(changed.slice(first, last), first, value.length - same, "preserve");
    if (area.matches(":focus")) {
      area.setSelectionRange(last, last);
      this.scrollTo(lineAt(changed, last));
    }
  }

  /** Bring the mirror up to date; the lines that changed by a gesture light up. */
  paint(isFresh) {
    const { value } = this.area;
    const lines = value.split("\n");
    const found = Map.groupBy(this.editor.state?.findings ?? [], ({ line }) => line);
    const marks = lines.map((_, index) => (found.get(index + 1) ?? []).map((finding) => markOf(finding, lines)));
    // Of a drawing, the characters of what is selected are marked.
    const { lines: [top, bottom] = [], columns: [left, right] = [] } = this.selection ?? {};
    const drawn = left === undefined ? [] : marks.slice(top - 1, bottom);
    for (const here of drawn) here.push({ from: left - 1, to: right, kind: "part" });
    const plain = value.length > MOST_COLORED ? lines.map(() => true) : plainLines(lines);
    const keys = lines.map((line, index) => `${Number(plain[index])}${JSON.stringify(marks[index])}${line}`);
    const [first, same] = sameEnds(keys, this.shown);
    const old = [...this.mirror.children].slice(first, this.shown.length - same);
    const next = this.mirror.children[this.shown.length - same] ?? null;
    const made = lines.slice(first, lines.length - same).map((line, index) => {
      const here = marks[first + index];
      const shown = lineElement(line, here, plain[first + index]);
      const isNew = isFresh && this.shown.length > 0 && line !== old[index]?.textContent.slice(0, -1);
      shown.classList.toggle("fresh", isNew);
      for (const { kind } of here) shown.classList.add(...kind.split(" "));
      return shown;
    });
    for (const each of old) each.remove();
    for (const each of made) this.mirror.insertBefore(each, next);
    this.shown = keys;
    this.mirror.style.setProperty("--digits", String(lines.length).length);
    this.area.setAttribute("aria-invalid", String(this.editor.state?.is_valid === false));
  }

  /** Mark the lines of what is selected, and scroll to them. */
  choose(scrolls = true) {
    const { lines: [first, last] = [] } = this.selection ?? {};
    [...this.mirror.children].forEach((line, index) =>
      line.classList.toggle("chosen", first <= index + 1 && index + 1 <= last),
    );
    if (scrolls && first !== undefined && !this.area.matches(":focus")) this.scrollTo(first);
  }

  /** Scroll so that a line can be seen, and nothing but the pane. */
  scrollTo(number) {
    const line = this.mirror.children[number - 1];
    if (line === undefined) return;
    const { pane } = this;
    const [top, bottom] = [line.offsetTop, line.offsetTop + line.offsetHeight];
    const margin = 2 * line.offsetHeight;
    if (top < pane.scrollTop + margin || bottom > pane.scrollTop + pane.clientHeight - margin) {
      pane.scrollTop = top - pane.clientHeight / 3;
    }
  }

  /** Put the caret at a place of the text. */
  goTo({ line, column }) {
    if (!this.pane.checkVisibility()) this.editor.set("panel", { panel: "file" });
    const lines = this.area.value.split("\n");
    const before = lines.slice(0, line - 1).reduce((total, each) => total + each.length + 1, 0);
    const at = before + [...(lines[line - 1] ?? "")].slice(0, column - 1).join("").length;
    this.area.focus({ preventScroll: true });
    this.area.setSelectionRange(at, at);
    this.scrollTo(line);
    this.showCaret();
  }

  // -- the caret ---------------------------------------------------------------------------------

  /** Select in the picture what the line of the caret is about. */
  showCaret() {
    this.tellFinding();
    const { state, selection } = this.editor;
    if (this.timer !== null || this.sending > 0 || !state.is_valid) return;
    const place = this.placeAt(this.area.value, this.area.selectionStart);
    if (place !== selection) this.editor.select(place);
  }

  /** Return the entry that a place of the text is about: of several, that with the fewest lines. */
  placeAt(content, at) {
    const number = lineAt(content, at);
    const column = [...content.slice(content.lastIndexOf("\n", at - 1) + 1, at)].length + 1;
    const isIn = (place, [first, last]) => first <= place && place <= last;
    const here = (this.editor.state.places ?? []).filter(
      ({ lines, columns }) => isIn(number, lines) && (columns === undefined || isIn(column, columns)),
    );
    const size = ({ lines: [first, last] }) => last - first;
    return here.reduce((best, each) => (best === null || size(each) < size(best) ? each : best), null);
  }

  findingsAt(number) {
    return (this.editor.state?.findings ?? []).filter(({ line }) => line === number);
  }

  /** Say below the text what was found in the line of the caret. */
  tellFinding() {
    const number = lineAt(this.area.value, this.area.selectionStart);
    const [found] = this.area.matches(":focus") ? this.findingsAt(number) : [];
    const told = found === undefined ? "" : `Line ${number}: ${found.message} (${found.code})`;
    this.note.replaceChildren(...prose(told));
    this.note.dataset.severity = found?.severity ?? "";
    // The message takes room from the text.
    if (told !== "") this.scrollTo(number);
  }

  // -- typing ------------------------------------------------------------------------------------

  typed() {
    if (this.timer === null) this.isJoined = Date.now() - this.typedAt < TYPING_STEP;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.flush(), TYPING_PAUSE);
    this.typedAt = Date.now();
    this.paint(false);
  }

  /** Send what was typed. */
  async flush() {
    if (this.timer === null) return;
    clearTimeout(this.timer);
    this.timer = null;
    const { editor, area } = this;
    const isOurs = this.sending > 0 || this.revision === editor.state.revision;
    this.sending += 1;
    const { state } = await editor.send({ do: "text", text: area.value, joined: isOurs && this.isJoined });
    this.sending -= 1;
    if (state === undefined) return; // Nobody has heard of it: what was typed stays.
    this.revision = state.revision;
    this.show();
    this.showCaret();
  }

  ask(what) {
    this.flush();
    this.typedAt = 0;
    this.editor.send({ do: what });
  }

  press(event) {
    const { key, shiftKey, altKey } = event;
    const isCommand = event.ctrlKey || event.metaKey;
    const isLeaving = this.leaves;
    this.leaves = key === "Escape";
    if (isCommand) this.flush(); // What commands are about has been typed.
    if (isCommand && !altKey && "zy".includes(key.toLowerCase())) {
      this.ask(key.toLowerCase() === "y" || shiftKey ? "redo" : "undo");
    } else if (key === "Tab" && !isCommand && !altKey && !shiftKey && !isLeaving) {
      this.indent();
    } else if (key === "Enter" && !isCommand && !altKey) {
      const { value, selectionStart } = this.area;
      const line = value.slice(value.lastIndexOf("\n", selectionStart - 1) + 1, selectionStart);
      this.insert(`\n${/^ */.exec(line)[0]}`);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Indent at the caret, or the lines that are selected. */
  indent() {
    const { value, selectionStart, selectionEnd } = this.area;
    const chosen = value.slice(selectionStart, selectionEnd);
    if (!chosen.includes("\n")) {
      this.insert(TEXT_INDENT);
      return;
    }
    const first = value.lastIndexOf("\n", selectionStart - 1) + 1;
    const lines = value.slice(first, selectionEnd);
    this.area.setRangeText(lines.replace(/^(?=.)/gm, TEXT_INDENT), first, selectionEnd, "select");
    this.typed();
  }

  insert(typed) {
    const { area } = this;
    area.setRangeText(typed, area.selectionStart, area.selectionEnd, "end");
    this.typed();
    this.scrollTo(lineAt(area.value, area.selectionStart));
  }
}

/** Return how many items of two texts, or lists, are the same at the beginning, and then at the end. */
function sameEnds(one, other) {
  const most = Math.min(one.length, other.length);
  let first = 0;
  while (first < most && one[first] === other[first]) first += 1;
  let same = 0;
  while (same < most - first && one.at(-1 - same) === other.at(-1 - same)) same += 1;
  return [first, same];
}

/** Return the number of the line of a place in a text. */
function lineAt(content, place) {
  return content.slice(0, place).split("\n").length;
}
