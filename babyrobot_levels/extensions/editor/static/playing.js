// Playing the level at hand: with the same luck each time.

import { html } from "../../../render/static/dom.js";
import { capital, formatted, GOAL, swiped } from "../../../render/static/game.js";
import { element } from "../../../render/static/paint.js";
import { Trail } from "../../../render/static/trail.js";
import { button, factRows } from "./html.js";

const PAD = [
  ["North", "n", 1, "M5 15l7-7 7 7"],
  ["West", "w", 4, "M15 5l-7 7 7 7"],
  ["Stay", "o", 0, "M12 9a3 3 0 1 0 0 6a3 3 0 1 0 0 -6z"],
  ["East", "e", 2, "M9 5l7 7-7 7"],
  ["South", "s", 3, "M5 9l7 7 7-7"],
];

export class Playing {
  constructor(editor, place) {
    this.editor = editor;
    editor.playing = this;
    this.place = place;
    this.seed = "0";
    this.facts = html("dl", { class: "episode" });
    this.message = html("p", { class: "episode-told", role: "status" });
    this.pad = PAD.map(([name, area, action, d]) =>
      button(element("svg", { viewBox: "0 0 24 24", "aria-hidden": true }, element("path", { d })), {
        class: `to-${area}`,
        "aria-label": name,
        "data-action": action,
        onclick: () => this.take(action),
      }),
    );
    /** @type {[string, string, () => void][]} */
    const quick = [
      ["Undo", "Z", () => this.undo()],
      ["Retry", "R", () => this.begin()],
      ["New luck", "N", () => this.newLuck()],
    ];
    place.append(
      this.facts,
      this.message,
      html("div", { class: "pad", role: "group", "aria-label": "Actions" }, ...this.pad),
      html(
        "div",
        { class: "quick" },
        ...quick.map(([name, key, onclick]) =>
          html("button", { type: "button", onclick }, `${name} `, html("kbd", {}, key)),
        ),
      ),
    );
    editor.on("state", () => this.isOn && this.begin());
    editor.on("mode", () => this.changeMode());
    this.changeMode();
    this.listenToSwipes(editor.stage.place);
  }

  get isOn() {
    return this.editor.mode === "play";
  }

  get game() {
    return this.editor.game;
  }

  /** Play, or edit again. */
  toggle() {
    this.editor.enter(this.isOn ? "edit" : "play");
  }

  changeMode() {
    this.place.hidden = !this.isOn;
    if (this.isOn) this.begin();
    else if (this.wasOn) this.end();
    this.wasOn = this.isOn;
  }

  /** Begin an episode, with the same luck as before. */
  begin() {
    if (!this.game) return;
    const { game, editor } = this;
    game.begin(this.seed);
    this.clear();
    this.trail = new Trail(game, editor.picture.svg);
    this.stand([game.data.goal ?? GOAL, game.turn].filter(Boolean).join(" "));
  }

  /** Leave the episode. */
  end() {
    const { game } = this;
    if (!game) return;
    game.begin(game.data.seed);
    this.editor.picture.stand();
    this.clear();
  }

  clear() {
    this.trail?.group.remove();
    this.trail?.arrow.remove();
  }

  newLuck() {
    this.seed = this.game.nextSeed;
    this.begin();
  }

  undo() {
    if (this.game.past.length === 0) {
      this.tell("There is no action to undo.");
      return;
    }
    this.game.undo();
    this.stand("Undone.");
  }

  /** Show the state of the game without a move. */
  stand(message) {
    this.editor.picture.stand();
    this.trail.stand();
    this.tell(message);
  }

  /** Move to a side. */
  go(side) {
    this.take(1 + "NESW".indexOf(side));
  }

  take(action) {
    const { game } = this;
    if (!this.isOn || !game) return;
    if (game.end !== null) {
      this.tell(`${game.describeEnd()} Retry, or take new luck.`, game.end);
      return;
    }
    this.trail.stand();
    const chosen = game.choose(action);
    if (chosen === null) {
      this.tell(game.turn);
      return;
    }
    const step = game.step(chosen);
    const isOver = game.end !== null;
    this.tell(
      [game.describeStep(step), isOver ? game.describeEnd() : game.turn].filter(Boolean).join(". "),
      isOver ? game.end : step.event,
    );
    this.editor.picture.go(step, () => this.trail.stand());
  }

  /** Show a message, and the numbers of the episode. */
  tell(message, kind = "") {
    const { game } = this;
    this.message.textContent = message;
    this.message.dataset.kind = kind;
    const facts = [
      ["Steps", String(game.steps)],
      ["Return", formatted(game.total)],
      ["Seed", this.seed],
    ];
    for (const [state, found] of game.things.met(game.configuration)) {
      facts.push([capital(state), found.map((thing) => thing.name).join(", ") || "nothing"]);
    }
    this.facts.replaceChildren(...factRows(facts));
    for (const each of this.pad) {
      const isShut = game.end === null && !game.isPossible(Number(each.dataset.action));
      each.classList.toggle("shut", isShut);
      each.ariaDisabled = String(game.end !== null);
    }
  }

  /** Listen to one pointer that swipes over the picture; a second one ends the swipe. */
  listenToSwipes(stage) {
    let from = null;
    stage.addEventListener("pointerdown", ({ isPrimary, button, clientX, clientY }) => {
      from = this.isOn && isPrimary && button === 0 ? [clientX, clientY] : null;
    });
    stage.addEventListener("pointermove", ({ clientX, clientY }) => {
      if (from === null) return;
      const [dx, dy] = [clientX - from[0], clientY - from[1]];
      const side = swiped(dx, dy);
      if (side === 0) return;
      from = null;
      this.take(side);
    });
    for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, () => (from = null));
  }
}
