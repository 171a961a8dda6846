// A policy drawn by hand: an action for some cells, and what it is worth beside the best one.

const DRAWN_ORDER = [-1, 1, 2, 3, 4, 0]; // What a click goes through: none, north, …, stay.
const ACTION_NAMES = ["stay", "north", "east", "south", "west"];

class PolicyDrawing {
  constructor(editor, place) {
    this.editor = editor;
    editor.policy = this;
    this.place = place;
    this.drawn = new Map(); // The action of a cell, by its coordinates as text.
    this.spots = null;
    this.facts = html("dl", { class: "worth" });
    this.told = html("p", { class: "worth-told", role: "status" });
    this.optimal = button("Take the optimal actions", { onclick: () => this.takeOptimal() });
    this.clear = button("Clear", { onclick: () => this.change(() => this.drawn.clear()) });
    place.append(
      this.facts,
      this.told,
      html("p", { class: "hint" },
        "Drag through cells to draw arrows; a click turns one. Cells without an arrow act at random."),
      html("div", { class: "quick" }, this.optimal, this.clear),
    );
    editor.on("state", () => this.follow());
    editor.on("mode", () => this.follow());
    this.listen(editor.stage.place);
    this.follow();
  }

  get isOn() {
    return this.editor.mode === "policy";
  }

  /** Show the policy in the level as it is now, and ask what it is worth there. */
  follow() {
    this.place.hidden = !this.isOn;
    if (!this.editor.game) return;
    this.show();
    if (this.isOn) this.ask();
  }

  change(changed) {
    changed();
    this.follow();
  }

  /** Set the action of a cell; -1 takes it out. */
  set(cell, action) {
    if (action < 0) this.drawn.delete(cell.join());
    else this.drawn.set(cell.join(), action);
  }

  /** Give the next action to a cell. */
  turn(cell) {
    const at = DRAWN_ORDER.indexOf(this.drawn.get(cell.join()) ?? -1);
    const action = DRAWN_ORDER[(at + 1) % DRAWN_ORDER.length];
    this.change(() => this.set(cell, action));
    this.editor.say(`${action < 0 ? "No arrow" : ACTION_NAMES[action]} at [${cell.join(", ")}].`);
  }

  /** Take the action of a cell out. */
  erase(cell) {
    this.change(() => this.set(cell, -1));
  }

  /** Draw an arrow in the cell of the cursor, and go where it leads. */
  step(side) {
    const { cell } = this.editor.cursor;
    this.change(() => this.set(cell, 1 + "NESW".indexOf(side)));
    const next = beyond(cell, side);
    const { width, height } = this.editor.game.data;
    const isInside = next[0] >= 0 && next[1] >= 0 && next[0] < width && next[1] < height;
    if (isInside) this.editor.set("cursor", { cursor: { cell: next, side: null } });
  }

  takeOptimal() {
    const { policy, width, marks } = this.editor.game.data;
    if (policy === null || marks === undefined) return;
    const first = this.editor.game.configuration * this.editor.game.cells;
    this.change(() => {
      for (let cell = 0; cell < this.editor.game.cells; cell++) {
        const at = [cell % width, Math.floor(cell / width)];
        this.set(at, policy[first + cell]);
      }
    });
  }

  // -- drawing ---------------------------------------------------------------------------------

  listen(stage) {
    const cancel = () => {
      if (this.spots !== null) this.change(() => (this.drawn = this.before));
      this.spots = null;
    };
    stage.addEventListener("pointerdown", (event) => {
      if (!event.isPrimary) cancel(); // Two fingers zoom.
      if (!this.isOn || !event.isPrimary || event.button !== 0 || !this.editor.game) return;
      this.spots = [this.editor.stage.spotAt(event)];
      this.before = new Map(this.drawn);
      stage.setPointerCapture(event.pointerId);
    });
    stage.addEventListener("pointermove", (event) => {
      if (this.spots === null) return;
      this.spots.push(this.editor.stage.spotAt(event));
      this.drawAlong(this.cells);
      this.show();
    });
    stage.addEventListener("pointerup", () => {
      if (this.spots === null) return;
      const { cells } = this;
      this.spots = null;
      if (cells.length === 1) this.turn(cells[0]);
      else this.follow();
    });
    stage.addEventListener("pointercancel", cancel);
  }

  /** The cells of the drag, which are in the level. */
  get cells() {
    const { width, height } = this.editor.game.data;
    return cellsAlong(this.spots).filter(([x, y]) => x >= 0 && y >= 0 && x < width && y < height);
  }

  /** Give each cell the direction in which the drag goes on; the last one keeps that before. */
  drawAlong(cells) {
    if (cells.length < 2) return;
    this.drawn = new Map(this.before);
    let action = -1;
    cells.forEach((cell, at) => {
      const next = cells[at + 1];
      if (next !== undefined) action = towards(cell, next);
      this.set(cell, action);
    });
  }

  show() {
    const layer = this.editor.stage.layer("drawn-policy");
    if (!this.isOn) {
      layer.replaceChildren();
      return;
    }
    const { width, height } = this.editor.game.data;
    const seen = [...this.drawn].map(([cell, action]) => [cell.split(",").map(Number), action])
      .filter(([[x, y]]) => x < width && y < height);
    layer.replaceChildren(...seen.map(([cell, action]) => this.arrow(cell, action)));
  }

  arrow([x, y], action) {
    const [left, top] = this.editor.game.corner(x + 0.5, y + 0.5);
    const size = COMMON.cell / 48;
    return element("path", {
      d: action === 0 ? "M-6 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0z" : "M0 -17l10 12h-6v18h-8v-18h-6z",
      transform: `translate(${left} ${top}) rotate(${90 * Math.max(0, action - 1)}) scale(${size})`,
    });
  }

  // -- what it is worth ------------------------------------------------------------------------

  /** Ask what the policy is worth, once more if it changes meanwhile. */
  async ask() {
    this.isStale = this.isAsking;
    if (this.isAsking || !this.editor.state.is_valid) return;
    this.isAsking = true;
    try {
      const { width, height } = this.editor.game.data;
      const actions = Array.from({ length: width * height }, (_, cell) =>
        this.drawn.get([cell % width, Math.floor(cell / width)].join()) ?? -1);
      const { policy } = await this.editor.ask({ do: "policy", actions });
      if (policy !== undefined) this.tell(policy);
    } finally {
      this.isAsking = false;
      if (this.isStale && this.isOn) this.ask();
    }
  }

  tell({ worth, best, share, exits, reason }) {
    const percent = (number) => `${formatted(100 * number)} %`;
    const facts = [
      ["This policy", worth || "undefined"],
      ["Best average", best || "none"],
      ["From random to best", share === null ? "–" : percent(share)],
      ["Reaches an exit", exits === null ? "–" : percent(exits)],
    ];
    this.facts.replaceChildren(...facts.map(([name, value]) => html("div", {}, html("dt", {}, name), html("dd", {}, value))));
    this.told.textContent = reason && `${reason[0].toUpperCase()}${reason.slice(1)}.`;
    this.told.hidden = reason === "";
  }
}

/** Return the move from a cell to a later one of a drag, as an action. */
function towards([x, y], [toX, toY]) {
  const [dx, dy] = [toX - x, toY - y];
  if (Math.abs(dx) >= Math.abs(dy)) return dx > 0 ? 2 : 4;
  return dy > 0 ? 3 : 1;
}
