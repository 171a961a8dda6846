// Learning while one draws: what is learned is kept while the level changes.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { capital } from "../../../render/static/game.js";
import { Learning } from "../../../render/static/learn.js";
import { Trail } from "../../../render/static/trail.js";

const LEARNED_FROM = ["width", "rows", "table", "starts", "max_steps", "discount"];
const INVALID = "The text has errors: learning goes on once they are corrected.";

/** Fill a place with the panel that pages have. */
function fill(place) {
  place.innerHTML = COMMON.learn;
  for (const each of place.querySelectorAll("kbd, [data-control]")) each.remove(); // They are for pages alone.
  const seed = html("input", { id: "seed", inputmode: "numeric", pattern: "[0-9]{1,40}", autocomplete: "off" });
  const [, ...others] = place.querySelector(".choices").children;
  place.querySelector(".sliders").append(...others, html("label", {}, "Seed ", seed));
  place.querySelector("#learn-numbers").after(html("p", { id: "message" }));
  place.prepend(html("p", { id: "spoken", class: "unseen", role: "status" }));
}

/** The panel in which algorithms learn the level at hand. */
export class LearningPanel extends Learning {
  constructor(editor, root, place, sets) {
    fill(place);
    super((configuration) => editor.picture.showsAnswers && sets.stand(true, configuration), root);
    this.editor = editor;
    editor.learning = this;
    this.reason = html("p", { class: "hint", role: "status" });
    place.prepend(this.reason);
    this.whole = root.querySelector(".editor");
    this.isSeen = false;
    this.waits = false; // Whether it runs on once the level is valid again.
    this.others = new Set(["values", "policy"]); // What the picture shows once the panel is shown, or another one.
    this.find("seed").addEventListener("change", ({ target }) => {
      if (target.value !== "" && target.checkValidity()) this.begin(target.value);
    });
    this.details.addEventListener("toggle", () => this.findCode());
    editor.on("state", () => this.renew());
    for (const event of ["panel", "mode"]) editor.on(event, () => this.look());
    editor.on("done", () => editor.done.do === "open" && this.forget());
  }

  /** Why the level at hand is not learned; empty if it is. */
  get refusal() {
    const { lacks, is_valid, too_large, answers } = this.editor.state;
    if (lacks === "" && !is_valid) return INVALID;
    const several = this.editor.game?.robots ? "algorithms learn for one robot; this level has several" : "";
    const reason = lacks || too_large || several || (answers.status === "none" ? answers.reason : "");
    return reason ? `${capital(reason)}.` : super.refusal;
  }

  /** Show what is learned, or what is exact. */
  look() {
    const { editor } = this;
    const isSeen = editor.panel === "algorithm" && editor.mode === "edit";
    if (isSeen === this.isSeen || editor.state === null) return;
    this.isSeen = isSeen;
    [editor.answers.shown, this.others] = [this.others, editor.answers.shown];
    editor.tell("state");
  }

  /** Show the level as it is now, and go on in it. */
  renew() {
    const { editor, learner, isSeen } = this;
    const { game, picture, answers } = editor;
    this.picture?.stop(); // It moves no longer where it is not shown.
    this.game = game ?? this.game;
    const refusal = isSeen ? this.refusal : "";
    const isFree = isSeen && refusal === "";
    if (this.isRunning && !isFree) {
      this.run(false);
      this.waits = isSeen;
    }
    const isSame =
      learner !== undefined &&
      game !== null &&
      LEARNED_FROM.every((name) => isEqual(name, game.data, learner.problem.data));
    const isOn = isSeen && (isFree || isSame);
    this.reason.textContent = refusal;
    this.panel.hidden = !isOn;
    this.whole.classList.toggle("learning", isOn);
    for (const button of this.panel.querySelectorAll("button")) button.disabled = !isFree;
    this.layer = null;
    if (!isOn) return;
    Object.assign(this, { picture, trail: new Trail(game, picture.svg) });
    this.attach();
    for (const layer of this.layer.own)
      layer.classList.toggle("hidden", !answers.shown.has(layer.id === "heat" ? "values" : layer.id));
    if (isSame) this.stand();
    else this.take();
    picture.showAnswers();
    this.findCode();
    if (this.waits && isFree) this.run(true);
    this.waits &&= !isFree;
  }

  /** Show what is known, without an update. */
  stand() {
    this.update = null;
    this.isStale = false;
    this.layer.begin(this.learner);
    this.show(null);
    this.showAll();
  }

  /** Learn other tables, with what is known of the states that are in both. */
  take() {
    const { options, learner } = this;
    const { data } = this.game;
    if (data.discount !== this.discount) options.discount = this.discount = data.discount;
    if (data.things) options.exploring_starts = false;
    if (learner === undefined || learner.number + learner.way.length === 0) {
      this.begin();
      return;
    }
    const { discount, exploring_starts } = options;
    Object.assign(learner.options, { discount, exploring_starts });
    const kept = learner.follow(data);
    const added = learner.problem.reached.length - kept;
    this.isMixed = true;
    this.showOptions();
    this.stand();
    this.say(`What was learned of ${kept} states is kept${added > 0 ? `, and ${added} are new` : ""}.`);
  }

  /** Begin anew once another level is opened. */
  forget() {
    this.learner = undefined;
    this.renew();
  }

  /** Do what a key stands for, in the panel. */
  command(name) {
    this.editor.set("panel", { panel: "algorithm" });
    const { textContent: refusal } = this.reason;
    if (refusal === "") this.commands[name]();
    else this.editor.say(refusal, "refused");
  }

  /** Ask for the share code, which the program in Python begins with. */
  async findCode() {
    const { game, editor } = this;
    if (!this.isOn || !this.details.open || game.data.code !== undefined) return;
    const { copy } = await editor.ask({ do: "copy", form: "code" });
    game.data = { ...game.data, code: copy };
    if (this.isOn && this.game === game) this.showNumbers();
  }
}

/** Return whether something is the same in the data of two levels. */
function isEqual(name, one, other) {
  return JSON.stringify(one[name]) === JSON.stringify(other[name]);
}
