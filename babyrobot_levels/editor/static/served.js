// The editor in a window of its own: its messages go to the server that it is from.

import { mount } from "./mount.js";

const UNREACHABLE =
  "The editor's server cannot be reached: it has ended, or the machine was asleep. Copy the text before you close this window.";

const connection = {
  /** Whether one can ask the other side to end. */
  ends: true,

  async send(message) {
    let response;
    try {
      response = await fetch("message", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify(message),
      });
    } catch {
      throw new Error(UNREACHABLE);
    }
    if (!response.ok) throw new Error(`The editor's server answered: ${(await response.text()).trim()}`);
    const reply = await response.json();
    if (reply.ended) end();
    return reply;
  },
};

/** Show that there is no server any more. */
function end() {
  window.removeEventListener("beforeunload", keep);
  document.removeEventListener("visibilitychange", refresh);
  document.body.textContent = "The editor has ended. You can close this window.";
}

/** Ask the user before unsaved changes are left. */
function keep(event) {
  if (editor.state !== null && !editor.state.is_saved) event.preventDefault();
}

/** Show what another window or program has changed, when one comes back. */
function refresh() {
  if (document.visibilityState === "visible") editor.send({ do: "state" });
}

const page = new CSSStyleSheet();
page.replaceSync("html, body, #editor { height: 100%; margin: 0; font-family: system-ui, sans-serif }");
document.adoptedStyleSheets = [page];

const style = await (await fetch("editor.css")).text();
const editor = mount(document.querySelector("#editor"), connection, style);
editor.stage.place.focus(); // The window's keys are the editor's.

editor.on("state", () => {
  const { is_saved, level, name, path } = editor.state;
  document.title = `${is_saved ? "" : "* "}${level?.title ?? path ?? name ?? "Level"} – editor`;
});

document.addEventListener("visibilitychange", refresh);
window.addEventListener("beforeunload", keep);
