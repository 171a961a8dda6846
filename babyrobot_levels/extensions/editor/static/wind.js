// The wind of each column and row.

import { html } from "../../../render/static/dom.js";
import { numberControl } from "./controls.js";
import { button } from "./html.js";

const WINDS = { N: "north", E: "east", S: "south", W: "west" };

export class WindPanel {
  constructor(editor) {
    this.editor = editor;
    this.key = "";
    this.list = html("div", { class: "fields" });
    const options = Object.entries(WINDS).map(([side, name]) => html("option", { value: side }, `to the ${name}`));
    this.side = html("select", { "aria-label": "Direction of the wind" }, ...options);
    this.label = html("span", {});
    this.index = numberControl({ label: "column or row", type: "integer", minimum: 0, default: 0 }, () => {});
    const add = button("Add", { onclick: () => this.add() });
    this.side.addEventListener("change", () => this.showLabel());
    this.showLabel();
    this.element = html(
      "div",
      { class: "fields" },
      this.list,
      html(
        "div",
        { class: "wind-new" },
        this.side,
        html("div", { class: "field-control" }, this.label, this.index.element, add),
      ),
    );
    editor.on("state", () => this.show());
    this.show();
  }

  showLabel() {
    this.label.textContent = lineOf(this.side.value);
  }

  show() {
    const wind = this.editor.state.fields?.wind ?? {};
    const blowing = Object.entries(WINDS).flatMap(([side, name]) =>
      (wind[name] ?? []).map((strength, index) => ({ side, index, strength })).filter(({ strength }) => strength > 0),
    );
    const key = blowing.map(({ side, index }) => `${side}${index}`).join();
    if (key !== this.key) {
      this.rows = blowing.map(({ side, index }) => this.row(side, index));
      this.list.replaceChildren(...this.rows.map(({ element }) => element));
    }
    this.key = key;
    blowing.forEach(({ strength }, number) => this.rows[number].show(strength));
  }

  /** Return the control of the wind in a column or row. */
  row(side, index) {
    const label = `${lineOf(side)} ${index}, to the ${WINDS[side]}`;
    const { element: shown, show } = numberControl({ label, type: "integer", minimum: 0 }, (strength) =>
      this.blow(side, index, strength ?? 0),
    );
    const none = button("✕", {
      class: "reset",
      "aria-label": `Remove the wind in ${label}`,
      onclick: () => this.blow(side, index, 0),
    });
    const control = html("span", { class: "field-control" }, shown, none);
    return { element: html("div", { class: "field" }, html("span", { class: "field-name" }, label), control), show };
  }

  add() {
    this.blow(this.side.value, this.index.value ?? 0, 1);
  }

  blow(side, index, strength) {
    this.editor.send({ do: "wind", side, index, strength });
  }
}

/** Return what a wind blows in. */
function lineOf(side) {
  return side === "N" || side === "S" ? "column" : "row";
}
