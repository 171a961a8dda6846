// The editor: what is shown, and the messages that change it. Everything else listens to it.

/**
 * The state of one editor. Its parts get it when they are made, and listen:
 *
 * - "state": another state came from Python (see `edit/state.py`);
 * - "cursor": the cell, and the side, at which the keyboard works;
 * - "selection": what is selected: the entry of `state.places`, or null;
 * - "caret": where the caret of the text was asked to go;
 * - "tool", "mode": another tool or mode ("edit", "play", "policy") was chosen;
 * - "said": a message for people.
 */
class Editor {
  constructor(connection) {
    this.connection = connection;
    this.state = null;
    this.cursor = { cell: [0, 0], side: null };
    this.selection = null;
    this.caret = null;
    this.tool = "walls";
    this.mode = "edit";
    this.listeners = new Map();
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

  /** Show a message for people; screen readers read it out. */
  say(message, kind = "") {
    this.set("said", { said: message, saidKind: kind });
  }

  /** Send a message, one after the other, and show the state that comes back. Returns the reply. */
  send(message) {
    const sent = this.last.then(async () => {
      this.count += 1;
      const revision = this.state?.revision;
      const reply = await this.connection.send({ id: this.count, revision, ...message });
      if (reply.error !== undefined) this.say(reply.error, "refused");
      if (reply.state !== undefined) this.set("state", { state: reply.state });
      return reply;
    });
    this.last = sent.catch((error) => this.say(String(error.message ?? error), "refused"));
    return sent;
  }
}
