// The fields of what is selected.

import { html } from "../../../render/static/dom.js";
import { capital } from "../../../render/static/game.js";
import { CONTROLS } from "./controls.js";
import { FieldRow, thingNames } from "./field_row.js";
import { Greeting } from "./greeting.js";
import { button, finder, tapped } from "./html.js";

const NOTHING = tapped(
  "Click something with the tool Select, press it long, or put the caret into its line of the text. " +
    "The fields of the level are under Level.",
);
const FIELDLESS = "It has no fields. Drag it to another cell, or draw another one with its tool.";

export class Inspector {
  constructor(editor, place) {
    this.editor = editor;
    this.rows = [];
    this.key = null;
    const find = finder(place);
    this.title = find("h2");
    this.remove = find(".remove");
    this.others = find(".others");
    this.body = find(".fields");
    this.remove.onclick = () => editor.removeSelected();
    this.greeting = new Greeting(editor, find(".steps"));
    this.body.replaceChildren(); // Until it is known what there is.
    editor.on("state", () => this.show());
    editor.on("selection", () => this.show());
  }

  show() {
    const { state, selection } = this.editor;
    this.forms = state.forms ?? this.forms ?? {};
    const greets = selection === null && this.greeting.isDue;
    const key = JSON.stringify([selection?.kind, selection?.route, greets]);
    if (key !== this.key) this.build(selection, greets);
    this.key = key;
    if (greets) this.greeting.show();
    const untitled = greets ? "Three steps to a level" : "Nothing is selected";
    this.title.textContent = selection === null ? untitled : titleOfPlace(selection);
    this.remove.classList.toggle("hidden", selection === null);
    this.showOthers(selection);
    for (const row of this.rows) row.show(row.base.length === 0 ? state.fields : selection.fields, thingNames(state));
  }

  /** Make the rows of an entry. */
  build(selection, greets) {
    const { kind, route } = selection ?? { kind: null, route: [] };
    // What the exits need is a field of the level: the same for all of them.
    const [form, base] =
      kind === "exit"
        ? [this.forms.level.filter(({ name }) => name === "exit_needs"), []]
        : [this.forms[kind] ?? [], route];
    this.rows = form.filter(({ type }) => type in CONTROLS).map((field) => new FieldRow(this.editor, field, base));
    const told = html("p", { class: "field-help" }, selection === null ? NOTHING : FIELDLESS);
    const help = greets ? this.greeting.element : told;
    this.body.replaceChildren(...(this.rows.length === 0 ? [help] : this.rows.map((row) => row.element)));
  }

  /** Offer what else stands in the same cells. */
  showOthers(selection) {
    const cells = new Set((selection?.cells ?? []).map(String));
    const others = (this.editor.state.places ?? []).filter(
      (place) => place !== selection && place.cells.some((cell) => cells.has(String(cell))),
    );
    const buttons = others.map((place) => button(place.label, { onclick: () => this.editor.select(place) }));
    this.others.replaceChildren(...(buttons.length === 0 ? [] : ["Also here: ", ...buttons]));
  }
}

/** Return what an entry is, and where. */
function titleOfPlace({ label, cells, sides }) {
  const [[x, y, side] = []] = [...sides, ...cells];
  const where = x === undefined ? "" : ` at [${x}, ${y}]${side === undefined ? "" : ` ${side}`}`;
  return capital(label) + where;
}
