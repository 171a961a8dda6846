// Python in a worker of this browser, and what connects editors with it.

export const STARTING = "Starting Python …";
export const FIRST_TIME = "The first time, this loads SITE_MEGABYTES MB.";

const PATIENCE = 30000; // Milliseconds that a message may take.
const TOO_SLOW =
  "Values of this level, and rules of play, take longer than 30 seconds here. They are not computed any more.";
const TOO_LONG =
  "This took longer than 30 seconds and was stopped. The level is as it was before; what was done cannot be undone any more.";

/** Python in a worker, which is ended and started again if an answer takes too long. */
export class Python {
  constructor() {
    this.count = 0;
    this.sessions = 0;
    this.hasMore = false;
    /** @type {((bytes: number) => void) | null} */
    this.onprogress = null;
    this.start();
  }

  start() {
    this.waiting = new Map();
    this.worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data: [number, result, error] }) => this.hear(number, result, error);
    this.worker.onerror = ({ message }) => {
      for (const number of [...this.waiting.keys()])
        this.hear(number, null, `Python cannot be started here (${message ?? "the worker failed"}).`);
    };
    // Settled once it has again what was loaded, where that can be had.
    this.ready = this.hasMore ? this.load().catch(() => {}) : Promise.resolve();
  }

  hear(number, result, error) {
    if (number === 0) this.onprogress?.(result); // So many bytes have been loaded.
    const { resolve, reject } = this.waiting.get(number) ?? {};
    this.waiting.delete(number);
    if (error === null) resolve?.(result);
    else reject?.(new Error(error));
  }

  /** Call a function of the worker, and return a promise of its result. */
  call(name, ...given) {
    this.count += 1;
    return new Promise((resolve, reject) => {
      this.waiting.set(this.count, { resolve, reject });
      this.worker.postMessage([this.count, name, ...given]);
    });
  }

  /** Load NumPy and SciPy. */
  async load() {
    await this.call("load");
    this.hasMore = true;
  }

  /** End the worker, whatever it does, and start another one. */
  restart() {
    this.worker.terminate();
    const { waiting } = this;
    this.start();
    for (const { reject } of waiting.values()) reject(new Error(TOO_LONG));
  }
}

/** The connection of an editor with a session of its own; see `mount`. */
export class PythonConnection {
  constructor(python, text, name) {
    this.python = python;
    this.key = python.sessions += 1;
    this.first = { text, name, revision: 0 };
    /** @type {Editor | null} */
    this.editor = null;
    this.begun = null;
    this.isSlow = false;
    this.ends = false;
    this.place = "in this browser";
    this.address = `${location.origin}${location.pathname}`;
    this.more = { title: "Load NumPy and SciPy", from: "SITE_MORE", load: () => python.load() };
  }

  /** Return a promise of the session, which begins anew in a new worker. */
  begin() {
    const { python } = this;
    if (this.worker !== python.worker) {
      this.worker = python.worker;
      const { text, name, revision } = this.editor?.state ?? this.first;
      this.begun = python.ready.then(() => python.call("begin", this.key, text, name ?? "", revision));
    }
    return this.begun;
  }

  async send(message) {
    const isAsked = message.do === "answers"; // By the editor itself, after each change.
    if (isAsked && this.isSlow) return {};
    await this.begin();
    const timer = setTimeout(() => {
      this.python.restart();
      if (!isAsked) return;
      this.isSlow = true;
      this.editor.say(TOO_SLOW, "refused");
    }, PATIENCE);
    try {
      return JSON.parse(await this.python.call("reply", this.key, JSON.stringify(message)));
    } finally {
      clearTimeout(timer);
    }
  }
}
