// The editor in a window of its own: its messages go to the server that it is from.

import { fillWindow } from "./window.js";

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

const editor = await fillWindow(connection);

document.addEventListener("visibilitychange", refresh);
window.addEventListener("beforeunload", keep);
