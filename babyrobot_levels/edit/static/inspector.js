// The fields of what is selected, or of the level.
const GROUPS = {
  text: "About the level",
  limit: "Episode",
  reward: "Rewards",
  dynamics: "Dynamics",
  geometry: "Geometry",
  look: "Look",
};
const ELSEWHERE = new Set(["version", "size", "map", "maze", "wind", "theme", "max_steps"]); // See world.js.

class Inspector {
  constructor(editor, place) {
    this.editor = editor;
    this.rows = [];
    this.key = null;
    this.title = html("h2", {});
    this.remove = button("Remove", { onclick: () => editor.removeSelected() });
    this.leave = button("Level", { title: "Show the fields of the level", onclick: () => editor.select(null) });
    this.head = html("div", { class: "inspector-head" }, this.title, this.remove, this.leave);
    this.others = html("p", { class: "others" });
    this.body = html("div", { class: "fields" });
    place.append(this.head, this.others, this.body);
    editor.on("state", () => this.show());
    editor.on("selection", () => this.show());
  }

  show() {
    const { state, selection } = this.editor;
    this.forms = state.forms ?? this.forms ?? {};
    const key = selection === null ? "" : JSON.stringify([selection.kind, selection.route]);
    if (key !== this.key) this.build(selection);
    this.key = key;
    this.showTitle(selection);
    const fields = (selection === null ? state.fields : selection.fields) ?? {};
    const names = thingNames(state);
    for (const row of this.rows) row.show(fields, names);
  }

  /** Make the rows of an entry, or of the level. */
  build(selection) {
    const { kind, route } = selection ?? { kind: "level", route: [] };
    const form = (this.forms[kind] ?? []).filter(({ type }) => type in CONTROLS);
    const isLevel = selection === null;
    const shown = isLevel ? form.filter((field) => !ELSEWHERE.has(field.route[0])) : form;
    this.rows = shown.map((field) => new FieldRow(this.editor, field, route));
    if (!isLevel) {
      this.body.replaceChildren(...this.rows.map(({ element }) => element));
      return;
    }
    const groups = Object.entries(GROUPS).map(([group, title]) => {
      const rows = this.rows.filter(({ field }) => field.group === group).map((row) => row.element);
      return rows.length === 0 ? null : html("details", {}, html("summary", {}, title), ...rows);
    });
    this.body.replaceChildren(...groups.filter((group) => group !== null));
  }

  showTitle(selection) {
    const isLevel = selection === null;
    const { label, cells, sides } = selection ?? { cells: [], sides: [] };
    const [[x, y, side] = []] = [...sides, ...cells];
    const where = x === undefined ? "" : ` at [${x}, ${y}]${side === undefined ? "" : ` ${side}`}`;
    this.title.textContent = isLevel ? "Level" : `${label[0].toUpperCase()}${label.slice(1)}${where}`;
    this.remove.classList.toggle("hidden", isLevel);
    this.leave.classList.toggle("hidden", isLevel);
    this.showOthers(selection);
  }

  /** Offer what else stands in the same cells. */
  showOthers(selection) {
    const cells = new Set((selection?.cells ?? []).map(String));
    const others = (this.editor.state.places ?? []).filter(
      (place) => place !== selection && place.cells.some((cell) => cells.has(String(cell))));
    const buttons = others.map((place) => button(place.label, { onclick: () => this.editor.select(place) }));
    this.others.replaceChildren(...(buttons.length === 0 ? [] : ["Also here: ", ...buttons]));
  }
}
