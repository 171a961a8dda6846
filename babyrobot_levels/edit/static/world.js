// The level itself: its size, maze, wind and theme, and all of its other fields.
const FIELD_GROUPS = {
  text: "About the level",
  limit: "Episode",
  reward: "Rewards",
  dynamics: "Dynamics",
  look: "Display",
};
const OWN_CONTROLS = new Set(["version", "size", "maze", "wind", "theme"]);

class World {
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
    this.size = pairControl({ label: "size", type: "size", maximum: own("size")[0]?.maximum },
      (size) => editor.send({ do: "resize", size }));
    const groups = Object.entries(FIELD_GROUPS).map(([group, title]) => {
      const fields = known.filter((field) => field.group === group && !OWN_CONTROLS.has(field.route[0]));
      const rows = fields.map((field) => new FieldRow(editor, field, []));
      this.rows.push(...rows);
      return section(title, ...rows.map(({ element }) => element));
    });
    const [about, ...others] = groups;
    const sized = html("div", { class: "field" }, html("span", { class: "field-name" }, "size"), this.size.element);
    this.place.replaceChildren(
      section("Size", sized),
      section("Maze", new MazePanel(editor, own("maze")).element),
      section("Wind", new WindPanel(editor).element),
      section("Theme", new ThemePanel(editor, own("theme")).element),
      ...others,
      about);
  }
}

/** Return a group of controls that can be collapsed. */
function section(title, ...children) {
  return html("details", { class: "group" }, html("summary", {}, title), html("div", { class: "fields" }, ...children));
}
