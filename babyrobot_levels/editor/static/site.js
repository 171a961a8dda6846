// The editor as a site: its messages go to Python in a worker of this browser.

import { fillWindow } from "./window.js";

const PATIENCE = 30000; // Milliseconds that a message may take.
const KEPT = `babyrobot-editor ${location.pathname}`;

/** Python in a worker, which is ended and started again if an answer takes too long. */
class Python {
  constructor() {
    this.count = 0;
    this.start();
  }

  start() {
    this.waiting = new Map();
    this.worker = new Worker("worker.js", { type: "module" });
    this.worker.onmessage = ({ data: [number, result, error] }) => this.hear(number, result, error);
    this.worker.onerror = ({ message }) => {
      for (const number of [...this.waiting.keys()])
        this.hear(number, null, `Python cannot be started here (${message ?? "the worker failed"}).`);
    };
  }

  hear(number, result, error) {
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

  /** End the worker, whatever it does, and start another one. */
  restart(why) {
    this.worker.terminate();
    const { waiting } = this;
    this.start();
    for (const { reject } of waiting.values()) reject(new Error(why));
  }
}

const TOO_LONG =
  "This took longer than 30 seconds and was stopped. The level is as it was before; what was done cannot be undone any more.";

const given = JSON.parse(document.querySelector("#begin").textContent);
const python = new Python();
let begun = python.call("begin", ...beginning(), 0);

/** Return the text to begin with, and its name: what was kept here, or what the site begins with. */
function beginning() {
  let kept = null;
  try {
    kept = JSON.parse(localStorage.getItem(KEPT));
  } catch {}
  const { text, name } = typeof kept?.text === "string" ? kept : given;
  return [text, name ?? ""];
}

const connection = {
  ends: false,
  place: "in this browser",
  address: `${location.origin}${location.pathname}`,
  more: {
    title: "Load NumPy and SciPy",
    from: "about 20 MB from cdn.jsdelivr.net",
    load: () => python.call("load"),
  },

  async send(message) {
    await begun;
    const timer = setTimeout(() => {
      python.restart(TOO_LONG);
      const { text, name, revision } = editor.state;
      begun = python.call("begin", text, name ?? "", revision);
    }, PATIENCE);
    try {
      return JSON.parse(await python.call("reply", JSON.stringify(message)));
    } finally {
      clearTimeout(timer);
    }
  },
};

/** Keep the text in this browser. */
function keep() {
  const { text, name } = editor.state;
  try {
    localStorage.setItem(KEPT, JSON.stringify({ text, name }));
  } catch {
    editor.say("This browser keeps nothing for this page: save the level as a file.", "refused");
  }
}

/** Open the level of the address: a code or a name after its `#`. */
function openAddress() {
  let source = location.hash.slice(1);
  if (source === "") return;
  try {
    source = decodeURIComponent(source);
  } catch {} // Then it is no code, which the session tells.
  // One that comes back later goes on with what was kept.
  history.replaceState(null, "", location.pathname);
  editor.send({ do: "open", source });
}

const editor = await fillWindow(connection);
const isKept = navigator.serviceWorker?.controller; // Nothing is loaded again.
editor.stage.notice.textContent = `Starting Python …${isKept ? "" : ` The first visit loads ${given.megabytes} MB.`}`;
begun.catch((error) => (editor.stage.notice.textContent = error.message));
editor.on("state", keep);
openAddress();
window.addEventListener("hashchange", openAddress);
begun.then(() => navigator.serviceWorker?.register("service.js"));
