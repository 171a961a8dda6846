// The editor: what is shown, and the messages that change it. Everything else listens to it.

import { capital } from "../../../render/static/game.js";
import { changed } from "./differences.js";
import { isSameCell } from "./spots.js";
import { DEFAULT_OPTIONS, sameRoute } from "./tools.js";

const NO_MODIFIERS = { rectangle: false, fill: false };

/**
 * The state of one editor. Its parts get it when they are made, and listen:
 *
 * - "state": another state came from Python (see `editor/state.py`); `game` and `picture` are drawn;
 * - "cursor": the cell, and the side, at which the keyboard works;
 * - "pointed": the cell under the pointer, or null;
 * - "selection": what is selected: the entry of `state.places`, or null;
 * - "caret": where the caret of the text was asked to go;
 * - "tool": another tool, other `options` of it, or other `modifiers` were chosen;
 * - "mode": another mode ("edit", "play", "policy") was chosen;
 * - "zoom": the picture has another size in the window;
 * - "panel": another panel is to be shown: the name of its class;
 * - "done": Python did what `done`, a message, asked for; of `undo` and `redo`, it has the `step`;
 * - "look": what is in the cell of the cursor is to be told;
 * - "help": the list of keys and gestures is to be shown;
 * - "said": a message for people.
 */
export class Editor {
  constructor(connection) {
    this.connection = connection;
    /** @type {EditorState | null} */
    this.state = null;
    /** @type {Game | null} */
    this.game = null;
    /** @type {Picture | null} */
    this.picture = null;
    /** @type {Stage | null} */
    this.stage = null;
    /** @type {Pointer | null} */
    this.pointer = null;
    this.said = "";
    this.saidKind = "";
    /** @type {Message | null} */
    this.refused = null; // What `said` is about.
    this.cursor = { cell: [0, 0], side: null };
    this.pointed = null;
    this.selection = null;
    this.caret = null;
    this.tool = "walls";
    this.options = structuredClone(DEFAULT_OPTIONS);
    /** @type {{ size: [number, number], picture: SVGElement } | null} */
    this.region = null; // What was copied, to be stamped.
    this.modifiers = NO_MODIFIERS;
    this.mode = "edit";
    this.panel = "inspector";
    this.done = null;
    this.listeners = new Map();
    /** @type {Promise<any>} */
    this.last = Promise.resolve();
    this.count = 0;
  }

  on(event, listener) {
    this.listeners.set(event, [...(this.listeners.get(event) ?? []), listener]);
  }

  tell(event) {
    for (const listener of this.listeners.get(event) ?? []) listener(this);
  }

  /** Set properties and tell those who listen to an event. */
  set(event, properties) {
    Object.assign(this, properties);
    this.tell(event);
  }

  /** Choose a tool; what is given of its options replaces those at hand. */
  choose(tool, options = {}) {
    const own = { ...this.options[tool], ...options };
    this.set("tool", { tool, options: Object.keys(own).length > 0 ? { ...this.options, [tool]: own } : this.options });
  }

  /** Switch what changes brushes on, of which one is on at a time. */
  toggle(name) {
    this.set("tool", { modifiers: { ...NO_MODIFIERS, [name]: !this.modifiers[name] } });
  }

  /** Choose a mode. Without the tables of levels, one can only edit; a policy is drawn for one robot. */
  enter(mode) {
    const lacks = this.lackFor(mode);
    if (lacks === "") this.set("mode", { mode });
    else this.say(`${capital(lacks)}.`, "refused");
  }

  /** Return why the level at hand has not got a mode; empty if it has. */
  lackFor(mode) {
    const { lacks = "", level } = this.state ?? {};
    if (mode === "policy" && level?.robots) return "a policy is drawn for one robot; this level has several";
    return mode === "edit" ? "" : lacks;
  }

  /** Select an entry of `state.places`; null selects the level itself. */
  select(selection) {
    this.set("selection", { selection });
  }

  /** Remove what is selected. */
  removeSelected() {
    if (this.selection !== null) this.send({ do: "remove", route: this.selection.route });
  }

  /** Show a message for people, perhaps about a message to Python that was refused; screen readers read it out. */
  say(message, kind = "", refused = null) {
    this.set("said", { said: message, saidKind: kind, refused });
  }

  /**
   * Send a message, one after the other, and show the state that comes back. Returns the reply; it
   * has an `error`, too, if the other side cannot be reached.
   */
  send(message) {
    const sent = this.last.then(async () => {
      /** @type {Reply} */
      const reply = await this.request(message).catch((error) => ({ error: error.message }));
      if (reply.error !== undefined) this.say(reply.error, "refused", message);
      if (reply.state !== undefined) this.show(reply.state, reply.error === undefined ? message : null);
      if (reply.error === undefined) this.set("done", { done: { ...message, step: reply.step } });
      return reply;
    });
    // A part that cannot show a state does not hold up the messages after it.
    this.last = sent.catch(() => {});
    return sent;
  }

  /** Ask what changes nothing, beside all other messages. Returns the reply, empty if none comes. */
  ask(question) {
    return this.request(question).catch(() => ({}));
  }

  /** Send a message with what it is about; returns its reply, with the whole state. */
  async request(message) {
    this.count += 1;
    const { number, revision } = this.state ?? {};
    return this.completed(await this.connection.send({ id: this.count, revision, has: number, ...message }));
  }

  /**
   * Return a reply with the whole state, if it has changes of the one at hand. Those of another one
   * are late: a later state is shown already.
   *
   * @param {Reply} reply
   * @returns {Reply}
   */
  completed(reply) {
    if (reply.changes === undefined || reply.from !== this.state?.number) return reply;
    return { ...reply, state: changed(this.state, reply.changes) };
  }

  /**
   * Show another state, which a message led to if one is given. What was selected stays so if it is
   * still there: in a drawing, what is moved is then at another route.
   */
  show(state, message = null) {
    const { selection } = this;
    const places = (state.places ?? []).filter(({ kind }) => kind === selection?.kind);
    const isMoved = message?.do === "move" && sameRoute(message, selection);
    this.selection =
      places.find((place) => sameRoute(place, selection)) ??
      places.find(({ cells }) => isMoved && cells.some((cell) => isSameCell(cell, message.to))) ??
      null;
    this.set("state", { state });
    if (this.lackFor(this.mode) !== "") this.set("mode", { mode: "edit" });
    if (selection !== null && this.selection === null) this.tell("selection");
  }
}
