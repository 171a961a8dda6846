// The maze that the walls begin with.

import { html, prose } from "../../../render/static/dom.js";
import { element } from "../../../render/static/paint.js";
import { FieldRow } from "./field_row.js";
import { button, buttonRow } from "./html.js";

const MOST_SEEDS = 10000; // Dice give short seeds.

/** Return how many entries open walls of the maze; null without a maze. @param {EditorState} state */
function openingsOf({ fields = {}, places = [] }) {
  return fields.maze === undefined ? null : places.filter(({ kind }) => kind === "opening").length;
}

/**
 * Offers to write the maze out as soon as one of its walls is opened, or as it has grown anew; and to
 * undo what removed more than it pointed at.
 */
export class Offers {
  constructor(editor, place) {
    const opening = button("Write the maze out", {
      title: "A wall of the maze was opened, by an entry of openings. Written out, each wall is an entry of its own.",
      onclick: () => editor.send({ do: "resolve" }),
    });
    const growing = button("Keep the walls of the maze", {
      title:
        "The maze has grown anew, since it begins at the first start and leaves out blocked cells. Written out as walls, it stays as it was.",
      onclick: () => editor.send({ do: "keep_maze" }),
    });
    const undo = button("Undo", { onclick: () => editor.send({ do: "undo" }) });
    place.prepend(undo, opening, growing);
    let before = null;
    const show = (offer, isShown) => offer.classList.toggle("hidden", !isShown);
    show(opening, false);
    editor.on("state", () => {
      const opened = openingsOf(editor.state);
      const isNew = before !== null && opened > before;
      if (isNew || !opened) show(opening, isNew);
      show(growing, editor.state.maze_regrown);
      show(undo, editor.state.lost);
      before = opened;
    });
    show(growing, false);
    show(undo, false);
  }
}

/** Grows, changes, removes and writes out the maze. */
export class MazePanel {
  constructor(editor, form) {
    this.editor = editor;
    this.rows = form.map((field) => new FieldRow(editor, { ...field, label: field.route.at(-1) }, []));
    const seed = this.rows.find(({ field }) => field.route.at(-1) === "seed");
    seed?.control.element.append(dice(() => this.roll()));
    this.note = html(
      "p",
      { class: "field-help" },
      ...prose(
        "The level removes walls of the maze: see `openings` in the text. They stay where they are if the " +
          "maze changes. Written out as walls, the maze can be changed wall by wall.",
      ),
    );
    this.inner = html(
      "div",
      { class: "fields" },
      ...this.rows.map(({ element }) => element),
      this.note,
      buttonRow(
        button("Write out as walls", { onclick: () => editor.send({ do: "resolve" }) }),
        button("Remove the maze", { onclick: () => editor.send({ do: "remove", route: ["maze"] }) }),
      ),
    );
    this.add = button("Grow a maze", { onclick: () => growMaze(editor) });
    this.element = html("div", {}, this.inner, this.add);
    editor.on("state", () => this.show());
    this.show();
  }

  show() {
    const { fields = {} } = this.editor.state;
    const opened = openingsOf(this.editor.state);
    this.inner.hidden = opened === null;
    this.add.hidden = opened !== null;
    this.note.hidden = !opened;
    for (const row of this.rows) row.show(fields, []);
  }

  roll() {
    this.set(["maze", "seed"], randomSeed());
  }

  set(route, value) {
    this.editor.send({ do: "set", route, value });
  }
}

/** Let the walls begin with a maze. */
export function growMaze(editor) {
  editor.send({ do: "set", route: ["maze"], value: { seed: randomSeed() } });
}

function randomSeed() {
  return Math.floor(Math.random() * MOST_SEEDS);
}

/** Return a button with dice. */
function dice(onclick) {
  const dots = [
    [8, 8],
    [16, 8],
    [12, 12],
    [8, 16],
    [16, 16],
  ].map(([cx, cy]) => element("circle", { cx, cy, r: 1.7 }));
  const icon = element(
    "svg",
    { viewBox: "0 0 24 24", class: "dice", "aria-hidden": "true" },
    element("rect", { x: 3, y: 3, width: 18, height: 18, rx: 4 }),
    ...dots,
  );
  return button(icon, { class: "step", title: "Another maze", "aria-label": "Another seed", onclick });
}
