// The wind of each column and row.

import { html } from "../../../render/static/dom.js";
import { numberControl } from "./controls.js";
import { button, finder } from "./html.js";
import { SIDE_NAMES } from "./spots.js";

export class WindPanel {
  constructor(editor, place) {
    this.editor = editor;
    this.key = "";
    const find = finder(place);
    this.list = find(".blowing");
    this.side = find("select");
    this.label = find("span");
    this.index = numberControl({ label: "column or row", type: "integer", minimum: 0, default: 0 }, () => {});
    this.label.after(this.index.element);
    this.side.onchange = () => this.showLabel();
    find(".add").onclick = () => this.add();
    this.showLabel();
    editor.on("state", () => this.show());
    this.show();
  }

  showLabel() {
    this.label.textContent = lineOf(this.side.value);
  }

  show() {
    const wind = this.editor.state.fields?.wind ?? {};
    const blowing = Object.entries(SIDE_NAMES).flatMap(([side, name]) =>
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
    const label = `${lineOf(side)} ${index}, to the ${SIDE_NAMES[side]}`;
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
    this.blow(this.side.value, this.index.read() ?? 0, 1);
  }

  blow(side, index, strength) {
    this.editor.send({ do: "wind", side, index, strength });
  }
}

/** Return what a wind blows in. */
function lineOf(side) {
  return side === "N" || side === "S" ? "column" : "row";
}
