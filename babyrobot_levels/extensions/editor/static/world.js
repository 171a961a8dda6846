// The level itself: its size, maze, wind and theme, and all of its other fields.

import { html } from "../../../render/static/dom.js";
import { capital } from "../../../render/static/game.js";
import { CONTROLS, pairControl } from "./controls.js";
import { FieldRow, thingNames } from "./field_row.js";
import { MazePanel } from "./maze.js";
import { ThemePanel } from "./theme.js";
import { WindPanel } from "./wind.js";

const SECTIONS = { text: "About the level", limit: "Episode" }; // Others are called as their fields.
const OWN_CONTROLS = new Set(["size", "maze", "wind", "theme"]);

export class World {
  constructor(editor, place) {
    this.editor = editor;
    this.place = place;
    this.rows = [];
    editor.on("state", () => this.show());
  }

  show() {
    const { state } = this.editor;
    if (state.forms !== undefined) this.build(state.forms.level);
    const [width, height] = [state.level?.width, state.level?.height];
    if (width !== undefined) this.size?.show([width, height]);
    for (const row of this.rows) row.show(state.fields, thingNames(state));
  }

  /** Make all groups of fields. */
  build(form) {
    if (this.rows.length > 0) return;
    const { editor } = this;
    const known = form.filter(({ type }) => type in CONTROLS);
    const own = (name) => known.filter(({ route }) => route[0] === name);
    this.size = pairControl({ ...own("size")[0], label: "size" }, (size) => editor.send({ do: "resize", size }));
    const groups = this.place.querySelector("template").content;
    const find = (name) => groups.querySelector(`.${name}`);
    find("size").append(this.size.element);
    new MazePanel(editor, find("maze"), own("maze"));
    new WindPanel(editor, find("winds"));
    new ThemePanel(editor, find("theming"), own("theme"));
    const [about, ...others] = this.sections(known.filter(({ route }) => !OWN_CONTROLS.has(route[0])));
    find("winds").closest(".group").before(about);
    groups.append(...others);
    for (const each of groups.children) {
      each.addEventListener("toggle", () => each.open && each.scrollIntoView({ block: "nearest" }));
    }
    this.place.replaceChildren(groups);
  }

  /** Return the sections of fields: those of one mapping together, the others by what they are for. */
  sections(fields) {
    const groups = new Map();
    for (const field of fields) {
      const [name, ...inner] = field.route;
      const group = inner.length > 0 ? name : field.group;
      const label = (inner.length > 0 ? inner : [name]).join(" ").replaceAll("_", " ");
      const row = new FieldRow(this.editor, { ...field, label }, []);
      this.rows.push(row);
      groups.set(group, [...(groups.get(group) ?? []), row.element]);
    }
    return [...groups].map(([group, rows]) => section(SECTIONS[group] ?? capital(group.replaceAll("_", " ")), ...rows));
  }
}

/** Return a group of controls that can be collapsed. */
function section(title, ...children) {
  return html("details", { class: "group" }, html("summary", {}, title), html("div", { class: "fields" }, ...children));
}
