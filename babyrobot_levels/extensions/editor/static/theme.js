// The theme: one of those that there are, colours of the level's own, and how well they stand out.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { element } from "../../../render/static/paint.js";
import { digitsOf } from "./controls.js";
import { FieldRow } from "./field_row.js";

const SHOWN_COLORS = ["base", "border", "exit", "puddle", "start", "walls"]; // On the button of a theme.

export class ThemePanel {
  constructor(editor, place, form) {
    this.editor = editor;
    this.template = place.querySelector(".theme");
    this.cards = Object.entries({ ...COMMON.themes, ...editor.state.themes }).map(([name, theme]) =>
      this.card(name, theme),
    );
    const colors = form.filter(({ route }) => route.length === 3);
    this.rows = colors.map(
      (field) => new ThemeRow(editor, { ...field, label: field.route.at(-1).replaceAll("_", " ") }, []),
    );
    this.summary = place.querySelector(".contrast");
    this.contrasts = place.querySelector(".contrasts");
    place.querySelector(".themes").replaceChildren(...this.cards);
    place.querySelector(".fields").append(...this.rows.map((row) => row.element));
    editor.on("state", () => this.show());
    this.show();
  }

  /** Return the button of a theme: a cell with a wall, a start, an exit and a puddle. */
  card(name, { colors }) {
    const made = this.template.cloneNode(true);
    for (const part of SHOWN_COLORS) made.style.setProperty(`--${part}`, colors[part]);
    made.append(name.replaceAll("_", " "));
    made.dataset.theme = name;
    made.onclick = () => this.choose(name);
    return made;
  }

  choose(name) {
    this.editor.send({ do: "set", route: ["theme"], value: name === "default" ? null : name });
  }

  show() {
    const { fields = {}, contrast = [], theme = COMMON.themes.default } = this.editor.state;
    const chosen = fields.theme ?? "default";
    for (const card of this.cards) card.setAttribute("aria-pressed", String(card.dataset.theme === chosen));
    const own = typeof chosen === "string" ? {} : chosen;
    for (const row of this.rows) row.showColor(own, theme);
    const faint = contrast.filter(({ is_enough }) => !is_enough);
    this.summary.textContent =
      faint.length === 0
        ? "Contrast: everything stands out"
        : `Contrast: ${faint.map(({ color }) => color).join(", ")} too low`;
    this.summary.classList.toggle("faint", faint.length > 0);
    const key = JSON.stringify([contrast, theme]);
    if (key === this.key) return;
    this.key = key;
    this.contrasts.replaceChildren(...contrast.map((pair) => this.contrast(pair, theme)));
  }

  /** Return the line of two colours. */
  contrast({ color, ground, ratio, least, is_enough: isEnough, remedy }, { colors }) {
    const chip = element(
      "svg",
      { viewBox: "0 0 30 20", "aria-hidden": "true" },
      element("rect", { width: 30, height: 20, rx: 3, fill: colors[ground] }),
      element("rect", { x: 8, y: 6, width: 14, height: 8, rx: 1, fill: colors[color] }),
    );
    const names = `${color} on ${ground}`.replaceAll("_", " ");
    const told = `${(Math.floor(10 * ratio) / 10).toFixed(1)} : 1, ${isEnough ? "enough" : `needs ${least}`}`;
    const help = isEnough ? null : html("span", { class: "field-help" }, remedy ?? "it is hard to see in pictures");
    return html(
      "li",
      { class: isEnough ? "enough" : "faint" },
      chip,
      html("span", {}, names),
      html("span", { class: "ratio" }, told),
      help,
    );
  }
}

/** A colour or width: a named theme becomes a mapping with this one changed. */
class ThemeRow extends FieldRow {
  showColor(own, theme) {
    this.theme = theme;
    this.own = own;
    const [, kind, name] = this.field.route;
    this.show({ theme: own }, []);
    this.control.element.querySelector("input:not([type=color])").placeholder = theme[kind][name];
    const palette = this.control.element.querySelector("[type=color]");
    if (palette !== null) palette.value = digitsOf(theme[kind][name]);
  }

  change(value) {
    if (Object.keys(this.own).length > 0) return super.change(value);
    const [, kind, name] = this.field.route;
    const next = {};
    for (const part of ["colors", "widths"]) {
      const changed = Object.entries({ ...this.theme[part], ...(part === kind ? { [name]: value } : {}) }).filter(
        ([key, each]) => each !== COMMON.themes.default[part][key],
      );
      if (changed.length > 0) next[part] = Object.fromEntries(changed);
    }
    return this.send(["theme"], next);
  }
}
