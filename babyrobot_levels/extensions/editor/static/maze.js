// The maze that the walls begin with.

import { FieldRow, thingNames } from "./field_row.js";
import { finder } from "./html.js";

const MOST_SEEDS = 10000; // Dice give short seeds.

/** Return how many entries open walls of the maze; null without a maze. @param {EditorState} state */
function openingsOf({ fields = {}, places = [] }) {
  return fields.maze === undefined ? null : places.filter(({ kind }) => kind === "opening").length;
}

/**
 * Offers to write the maze out as soon as one of its walls is opened, or as it has grown anew; and to
 * undo what removed more than it pointed at. Where nothing can open a door, it offers to draw a key first.
 */
export class Offers {
  constructor(editor, place) {
    const [undo, opening, growing, key] = place.children;
    let before = null;
    /** @type {Message | null} */
    let door = null; // What is drawn once there is a key.
    const show = (offer, isShown) => offer.classList.toggle("hidden", !isShown);
    editor.on("state", () => {
      const opened = openingsOf(editor.state);
      const isNew = before !== null && opened > before;
      if (isNew || !opened) show(opening, isNew);
      show(growing, editor.state.maze_regrown);
      show(undo, editor.state.lost);
      before = opened;
    });
    editor.on("said", () => {
      show(key, editor.refused?.to === "door" && thingNames(editor.state).length === 0);
    });
    key.onclick = () => {
      door = editor.refused;
      editor.choose("item", { shape: "key" });
      editor.stage.place.focus();
      editor.say("Put the key into a cell: then the door is drawn.");
    };
    editor.on("done", () => {
      const { brush } = editor.done;
      if (door !== null && brush === "item") {
        editor.choose("door");
        editor.send(door);
      }
      door = null;
    });
  }
}

/** Grows, changes, removes and writes out the maze. */
export class MazePanel {
  constructor(editor, place, form) {
    this.editor = editor;
    this.rows = form.map((field) => new FieldRow(editor, { ...field, label: field.route.at(-1) }, []));
    const find = finder(place);
    this.inner = find(".grown");
    this.note = find(".field-help");
    this.add = find(".grow");
    this.add.onclick = () => growMaze(editor);
    find(".remove").onclick = () => editor.send({ do: "remove", route: ["maze"] });
    find(".roll").onclick = () => editor.send({ do: "set", route: ["maze", "seed"], value: randomSeed() });
    const seed = this.rows.find(({ field }) => field.route.at(-1) === "seed");
    seed?.control.element.append(find(".roll"));
    this.inner.prepend(...this.rows.map(({ element }) => element));
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
}

/** Let the walls begin with a maze. */
export function growMaze(editor) {
  editor.send({ do: "set", route: ["maze"], value: { seed: randomSeed() } });
}

function randomSeed() {
  return Math.floor(Math.random() * MOST_SEEDS);
}
