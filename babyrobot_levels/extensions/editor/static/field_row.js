// One field of the level or of an entry: its name, its control, and what is wrong with its value.

import { COMMON } from "../../../render/static/common.js";
import { html, prose } from "../../../render/static/dom.js";
import { CONTROLS } from "./controls.js";
import { button } from "./html.js";

export class FieldRow {
  /** `field` is one of `editor/forms.py`; `base` the route of its entry, empty for the level. */
  constructor(editor, field, base) {
    this.editor = editor;
    this.field = field;
    this.base = base;
    this.isSending = false;
    const label = field.label ?? field.route.join(" ").replaceAll("_", " ");
    this.control = CONTROLS[field.type]({ ...field, label }, (value) => this.change(value));
    this.reset = button("↺", {
      class: "reset",
      title: "Reset to the default",
      "aria-label": `Reset ${label}`,
      onclick: () => this.change(null),
    });
    this.error = html("p", { class: "field-error", role: "alert" });
    this.element = html(
      "div",
      { class: "field" },
      html("span", { class: "field-name" }, label),
      html("span", { class: "field-control" }, this.control.element, this.reset),
      html("p", { class: "field-help" }, ...prose(field.description ?? "")),
      this.error,
    );
    this.element.dataset.name = field.name;
  }

  /** Show the value that the fields of the entry have; `names` are those that can be needed. */
  show(fields, names) {
    if (this.isSending) return;
    const { field } = this;
    const value = field.route.reduce((inner, key) => inner?.[key], fields) ?? undefined;
    const owner = field.with === undefined ? true : fields[field.with] !== undefined;
    this.value = value;
    this.element.classList.toggle("hidden", !owner);
    this.reset.classList.toggle("hidden", value === undefined || field.required === true);
    this.fail("");
    this.control.show(value, names);
  }

  change(value) {
    return this.send([...this.base, ...this.field.route], value);
  }

  async send(route, value) {
    this.isSending = true;
    const { error = "" } = await this.editor.send({ do: "set", route, value }).finally(() => (this.isSending = false));
    // What was refused stays, to be corrected.
    if (error === "") this.editor.tell("state");
    this.fail(error);
  }

  fail(error) {
    this.error.replaceChildren(...prose(error));
    this.element.classList.toggle("failed", error !== "");
    if (error !== "") this.error.scrollIntoView({ block: "nearest" });
  }
}

/** Return the names of the things of a level that doors and exits can need. */
export function thingNames({ places = [] }) {
  const things = places.filter(({ kind }) => kind in COMMON.needed);
  return [...new Set(things.map(({ label }) => label))];
}
