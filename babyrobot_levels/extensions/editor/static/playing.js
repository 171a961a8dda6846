// Playing the level at hand: with the same luck each time.

import { capital, formatted, GOAL, swiped } from "../../../render/static/game.js";
import { Trail } from "../../../render/static/trail.js";
import { factRows } from "./html.js";

export class Playing {
  constructor(editor, place) {
    this.editor = editor;
    editor.playing = this;
    this.place = place;
    this.seed = "0";
    this.facts = place.querySelector(".episode");
    this.message = place.querySelector(".episode-told");
    this.pad = place.querySelectorAll("[data-action]");
    for (const each of this.pad) each.onclick = () => this.take(Number(each.dataset.action));
    const [undo, retry, luck] = place.querySelector(".quick").children;
    undo.onclick = () => this.undo();
    retry.onclick = () => this.begin();
    luck.onclick = () => this.newLuck();
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
