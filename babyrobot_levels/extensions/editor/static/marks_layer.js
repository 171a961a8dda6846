// Marks in the picture: findings at their cells and sides, cells that cannot be reached, and those
// whose values the last change changed.

import { COMMON } from "../../../render/static/common.js";
import { html, prose } from "../../../render/static/dom.js";
import { element } from "../../../render/static/paint.js";
import { isSameCell } from "./spots.js";

const SIGN = 0.3; // The side of a finding's sign, in cells.

export class MarksOverlay {
  constructor(editor, place) {
    this.editor = editor;
    this.note = html("p", { class: "finding-note", "aria-hidden": "true", hidden: true });
    place.append(this.note);
    editor.on("state", () => this.show());
    editor.on("mode", () => this.show());
    editor.on("cursor", () => this.point(editor.cursor.cell));
    const { place: stage } = editor.stage;
    stage.addEventListener("pointermove", (event) => this.editor.game && this.point(editor.stage.spotAt(event).cell));
    stage.addEventListener("pointerleave", () => this.point(null));
  }

  show() {
    const { editor } = this;
    this.point(null);
    if (!editor.game) return;
    const { unreachable, findings, answers, revision } = editor.state;
    const isEditing = editor.mode === "edit";
    this.draw("unreachable", this.hatched(isEditing ? unreachable : []));
    this.draw(
      "found",
      isEditing ? findings.filter(({ cells, sides }) => cells.length + sides.length > 0) : [],
      (finding) => this.sign(finding),
    );
    // Each change is shown once.
    const isNew = this.flashed !== revision && editor.answers.shown.has("values") && !editor.learning?.isSeen;
    this.draw("changed", isNew && answers.changed.length > 0 ? [editor.game.squares(answers.changed)] : [], (d) =>
      element("path", { d }),
    );
    if (answers.status === "done") this.flashed = revision;
  }

  draw(name, shapes, drawn = (shape) => shape) {
    this.editor.stage.layer(name).replaceChildren(...shapes.map(drawn));
  }

  /** Return the hatching of cells: strokes that go on from cell to cell. */
  hatched(cells) {
    if (cells.length === 0) return [];
    const side = COMMON.cell;
    const strokes = cells.map((cell) => {
      const [x, y] = this.editor.game.corner(...cell);
      const line = (from) => `M${x + from * side} ${y}L${x} ${y + from * side}`;
      const rest = (from) => `M${x + side} ${y + from * side}L${x + from * side} ${y + side}`;
      return [0.25, 0.5, 0.75, 1].map(line).join("") + [0.25, 0.5, 0.75].map(rest).join("");
    });
    return ["under", "over"].map((name) => element("path", { d: strokes.join(""), class: name }));
  }

  /** Return the outline of where a finding is, and its sign. */
  sign({ severity, cells, sides, is_outdated: isOutdated }) {
    const { game } = this.editor;
    const side = COMMON.cell;
    const lines = sides.map((each) => sideLine(game, each)).join("");
    const [x, y] =
      sides.length > 0
        ? middleOfSide(game, sides[0])
        : game.corner(cells[0][0] + 1 - SIGN / 1.6, cells[0][1] + SIGN / 1.6);
    const size = (SIGN * side) / 2;
    return element(
      "g",
      { class: `finding-mark ${severity}${isOutdated ? " outdated" : ""}` },
      element("path", { d: (cells.length > 1 ? game.squares(cells, 2) : "") + lines, class: "where" }),
      element(
        "g",
        { transform: `translate(${x} ${y}) scale(${size / 10})`, class: "sign" },
        element("circle", { r: 10 }),
        element("path", { d: severity === "info" ? "M0 -1v6M0 -5v.1" : "M0 -5v6M0 5v.1" }),
      ),
    );
  }

  /** Tell the findings of a cell, or none. */
  point(cell) {
    const { state, mode } = this.editor;
    const isHere = (cells) => cell !== null && mode === "edit" && cells.some((each) => isSameCell(each, cell));
    const found = isHere([cell]) ? state.findings.filter(({ cells, sides }) => isHere([...cells, ...sides])) : [];
    const isUnreachable = isHere(state?.unreachable ?? []);
    const words = found.map(({ message }) => prose(message));
    if (isUnreachable && words.length === 0) words.push(["no episode can come here"]);
    this.note.hidden = words.length === 0;
    this.note.replaceChildren(...words.map((parts) => html("span", {}, ...parts)));
  }
}

function sideLine(game, [x, y, side]) {
  const [left, top] = game.corner(x + Number(side === "E"), y + Number(side === "S"));
  return `M${left} ${top}${"NS".includes(side) ? "h" : "v"}${COMMON.cell}`;
}

function middleOfSide(game, [x, y, side]) {
  const shift = { N: [0.5, 0], E: [1, 0.5], S: [0.5, 1], W: [0, 0.5] }[side];
  return game.corner(x + shift[0], y + shift[1]);
}
