// The optimum of the level: its return, what the last change did to it, and what the picture shows.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { capital, formatted } from "../../../render/static/game.js";
import { ShownSets } from "../../../render/static/shown.js";
import { finder } from "./html.js";

const IDLE = 400; // Milliseconds without a change before what takes longer is computed.

/** The strip with the best return, and the switches of values and optimal actions. */
export class Answers {
  constructor(editor, place) {
    this.editor = editor;
    editor.answers = this;
    this.shown = new Set();
    place.innerHTML = COMMON.answers;
    const find = finder(place);
    this.line = find(".best-line");
    this.name = find(".best-name");
    this.best = find(".best-return");
    this.change = find(".change");
    this.reason = find(".reason");
    this.group = find(".switches");
    this.switches = this.group.children;
    for (const each of this.switches) each.onclick = () => this.toggle(each.dataset.shown);
    this.load = find(".load");
    this.load.onclick = () => this.loadMore(editor.connection.more);
    // Before the picture is drawn, which shows what the data says.
    editor.on("state", () => this.show());
  }

  /** Show values or optimal actions, or no longer. */
  toggle(name) {
    const { answers } = this.editor.state;
    if (answers.status === "none") {
      this.editor.say(answers.reason || "There is no level to solve yet.", "refused");
      return;
    }
    if (!this.shown.delete(name)) this.shown.add(name);
    this.editor.tell("state");
  }

  show() {
    const { level, answers, revision, findings_pending: hasMoreFindings, lacks } = this.editor.state;
    const { more } = this.editor.connection;
    for (const each of [this.line, this.group]) each.hidden = lacks !== "";
    this.load.hidden = lacks === "" || more === undefined;
    this.load.replaceChildren(more?.title ?? "", " ", html("small", {}, more?.from ?? ""));
    if (level !== null) level.shown = answers.status === "none" ? [] : [...this.shown];
    const isPending = answers.status === "pending";
    this.name.textContent = answers.best_name;
    this.best.textContent = isPending ? "…" : answers.best_text || "none";
    this.best.classList.toggle("pending", isPending);
    const way = wayOf(answers);
    this.change.textContent = isPending ? "is computed when you pause" : changeInWords(answers, way);
    this.change.dataset.way = way;
    this.reason.textContent = answers.reason && `${capital(answers.reason)}.`;
    this.reason.hidden = answers.reason === "";
    const isLearning = this.editor.learning?.isSeen; // Then the picture shows what is learned.
    for (const each of this.switches) {
      const { title, hint } = each.dataset;
      each.firstChild.textContent = `${isLearning ? title.replace("Optimal", "Greedy") : title} `;
      each.title = isLearning ? "" : hint;
      each.setAttribute("aria-pressed", this.shown.has(each.dataset.shown));
      each.disabled = answers.status === "none";
    }
    clearTimeout(this.timer);
    if ((isPending || hasMoreFindings) && this.asked !== revision)
      this.timer = setTimeout(() => this.ask(revision), IDLE);
  }

  /** Load what the tables of levels need. */
  async loadMore({ load }) {
    this.load.disabled = true;
    this.load.textContent = "Loading …";
    try {
      await load();
      await this.editor.send({ do: "state" });
    } catch (error) {
      this.editor.say(/** @type {Error} */ (error).message, "refused");
      this.show();
    }
    this.load.disabled = false;
  }

  /** Ask for the optimum and the findings that take longer, beside all other messages. */
  async ask(revision) {
    this.asked = revision;
    const { state } = await this.editor.ask({ do: "answers" });
    if (state === undefined)
      this.asked = null; // The next change asks again, or tells that nobody answers.
    else if (state.revision === this.editor.state.revision) this.editor.show(state);
  }
}

/** Offer for what is held values and actions are shown while one edits; return the choice. */
export function offerSets(editor, place) {
  const fieldset = html("fieldset", { class: "sets" });
  const sets = new ShownSets(fieldset, (configuration) => editor.picture.look(configuration));
  place.append(fieldset);
  const follow = () => {
    const { game, picture, mode } = editor;
    fieldset.hidden = true;
    if (game === null || !picture.showsAnswers) return;
    if (mode !== "edit") {
      fieldset.hidden = game.data.picture.never === undefined;
      fieldset.replaceChildren(html("p", {}, "Hatched: cannot occur with what is held."));
      return;
    }
    const { words } = sets;
    sets.begin(game);
    sets.stand(true);
    if (words !== sets.words && sets.all.has(words)) sets.choose(words);
  };
  editor.on("state", follow);
  editor.on("mode", follow);
  return sets;
}

/** Describe what the last change did to the optimum; the empty text for nothing. */
function changeInWords({ before, changed }, way) {
  const cells = changed.length > 0 && `${changed.length} cell${changed.length === 1 ? "" : "s"} changed`;
  return [way && `was ${formatted(before)}`, cells].filter(Boolean).join(", ");
}

/** Return whether the optimum went "up" or "down" by the last change; the empty text for neither. */
function wayOf({ best, before }) {
  if (best === null || before === null || formatted(best) === formatted(before)) return "";
  return best > before ? "up" : "down";
}
