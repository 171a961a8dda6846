// A policy drawn by hand: an action for some cells, and what it is worth beside the best one.

import { COMMON } from "../../../render/static/common.js";
import { capital, formatted, SIDES } from "../../../render/static/game.js";
import { element } from "../../../render/static/paint.js";
import { button, factRows, finder } from "./html.js";
import { beyond, cellsAlong } from "./spots.js";
import { insideOf, isInside } from "./tools.js";

const DRAWN_ORDER = [-1, 1, 2, 3, 4, 0]; // What a click goes through: none, north, …, stay.
const ANYTHING = "Anything"; // Arrows for whatever is held and on.

export class PolicyDrawing {
  constructor(editor, place) {
    this.editor = editor;
    editor.policy = this;
    this.place = place;
    this.drawn = new Map(); // By what is held: the action of a cell, by its coordinates as text.
    this.held = ANYTHING; // What arrows are drawn for.
    this.spots = null;
    const find = finder(place);
    this.facts = find(".worth");
    this.told = find(".worth-told");
    this.holding = find(".holding");
    this.chips = find(".chips");
    this.moving = find(".moving");
    find(".optimal").onclick = () => this.takeOptimal();
    find(".clear").onclick = () => this.change(() => this.drawn.clear());
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
    const { game, mode } = this.editor;
    this.place.hidden = !this.isOn;
    if (!game) return;
    if (this.isOn) this.look();
    else if (this.wasOn && mode === "edit") {
      game.begin(game.data.seed);
      this.editor.picture.stand();
    }
    this.wasOn = this.isOn;
    this.show();
    if (this.isOn) this.ask();
  }

  change(changed) {
    changed();
    this.follow();
  }

  /** Show the things as they are while that is held which arrows are drawn for. */
  look() {
    const { game, picture } = this.editor;
    if (this.game !== game) this.findSituations(game);
    for (const chip of this.chips.children) chip.ariaPressed = String(chip.textContent === this.held);
    const configuration = this.situations.get(this.held) ?? game.configurationOf(game.data.starts[0]);
    game.state = configuration * game.cells + (game.state % game.cells);
    picture.stand();
  }

  /** Note what can be held and on, in words, each with the first configuration in which it is. */
  findSituations(game) {
    this.game = game;
    const { things, cells, data } = game;
    const configurations = data.possible.length / cells;
    this.words = Array.from({ length: configurations }, (_, configuration) => things.words(configuration));
    this.situations = things.situations(configurations);
    this.begun = this.words[game.configurationOf(data.starts[0])];
    const names = [...this.situations.keys()];
    if (!this.situations.has(this.held)) this.held = ANYTHING;
    this.moving.hidden = things.of("mover").length === 0;
    this.holding.hidden = names.length < 2;
    this.chips.replaceChildren(
      ...[ANYTHING, ...names].map((held) => button(held, { onclick: () => this.change(() => (this.held = held)) })),
    );
  }

  /** Return the action of a cell, by default in what is shown; -1 for none. */
  actionAt(cell, held = this.held === ANYTHING ? this.begun : this.held) {
    const [own, any] = [held, ANYTHING].map((each) => this.drawn.get(each)?.get(cell.join()));
    return own ?? any ?? -1;
  }

  /** Set the action of a cell; -1 takes it out. One for anything takes the place of all others. */
  set(cell, action, held = this.held) {
    for (const [each, actions] of this.drawn) if (held === ANYTHING || each === held) actions.delete(cell.join());
    if (action < 0) return;
    if (!this.drawn.has(held)) this.drawn.set(held, new Map());
    this.drawn.get(held).set(cell.join(), action);
  }

  /** Give the next action to a cell. */
  turn(cell) {
    const at = DRAWN_ORDER.indexOf(this.actionAt(cell));
    const action = DRAWN_ORDER[(at + 1) % DRAWN_ORDER.length];
    this.change(() => this.set(cell, action));
    this.editor.say(`${action < 0 ? "No arrow" : SIDES[action] || "stay"} at [${cell.join(", ")}].`);
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
    if (isInside(this.editor, next)) this.editor.set("cursor", { cursor: { cell: next, side: null } });
  }

  /** Take the optimal actions, of what is held at hand or of all that can be. */
  takeOptimal() {
    const { game } = this.editor;
    const { policy, marks } = game.data;
    if (policy === null || marks === undefined) return;
    const taken = [...this.situations].filter(([held]) => this.held === ANYTHING || held === this.held);
    this.change(() => {
      for (const [held, configuration] of taken) {
        for (let cell = 0; cell < game.cells; cell++) {
          this.set(game.place(cell), policy[configuration * game.cells + cell], held);
        }
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
      this.before = structuredClone(this.drawn);
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
    return insideOf(this.editor, cellsAlong(this.spots));
  }

  /** Give each cell the direction in which the drag goes on; the last one keeps that before. */
  drawAlong(cells) {
    if (cells.length < 2) return;
    this.drawn = structuredClone(this.before);
    let action = -1;
    cells.forEach((cell, at) => {
      const next = cells[at + 1];
      if (next !== undefined) action = towards(cell, next);
      this.set(cell, action);
    });
  }

  get allCells() {
    const { game } = this.editor;
    return Array.from({ length: game.cells }, (_, cell) => game.place(cell));
  }

  show() {
    const layer = this.editor.stage.layer("drawn-policy");
    if (!this.isOn) {
      layer.replaceChildren();
      return;
    }
    const seen = this.allCells.map((cell) => [cell, this.actionAt(cell)]).filter(([, action]) => action >= 0);
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
      const cells = this.allCells;
      const rows = new Map(
        [...this.situations.keys()].map((held) => [held, cells.map((cell) => this.actionAt(cell, held))]),
      );
      const actions = this.words.flatMap((held) => rows.get(held));
      const { policy } = await this.editor.ask({ do: "policy", actions });
      if (policy !== undefined) this.tell(policy);
    } finally {
      this.isAsking = false;
      if (this.isStale && this.isOn) this.ask();
    }
  }

  tell({ worth, best, share, exits, reason }) {
    const facts = [
      ["This policy", worth || "undefined"],
      ["Best average", best || "none"],
      ["Beside random actions", share === null ? "–" : shareInWords(share)],
      ["Reaches an exit", exits === null ? "–" : percent(exits)],
    ];
    this.facts.replaceChildren(...factRows(facts));
    this.told.textContent = reason && `${capital(reason)}.`;
    this.told.hidden = reason === "";
  }
}

function percent(share) {
  return `${formatted(100 * share)} %`;
}

/** Describe how far a policy is on the way from random actions (0) to the best one (1). */
function shareInWords(share) {
  if (share < -0.0001) return "worse";
  if (share > 0.9999) return "as good as the best";
  return share < 0.0001 ? "no better" : `${percent(share)} of the way to the best`;
}

/** Return the move from a cell to a later one of a drag, as an action. */
function towards([x, y], [toX, toY]) {
  const [dx, dy] = [toX - x, toY - y];
  if (Math.abs(dx) >= Math.abs(dy)) return dx > 0 ? 2 : 4;
  return dy > 0 ? 3 : 1;
}
