// The editor in a window of its own: its messages go to the server that it is from.

import { mount } from "./editor.js";

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
    return response.json();
  },
};

const page = new CSSStyleSheet();
page.replaceSync("html, body, #editor { height: 100%; margin: 0 }");
document.adoptedStyleSheets = [page];

const style = await (await fetch("editor.css")).text();
const editor = mount(document.querySelector("#editor"), connection, style);
editor.stage.place.focus(); // The window's keys are the editor's.

editor.on("state", () => {
  const { is_saved, level, name, path } = editor.state;
  document.title = `${is_saved ? "" : "* "}${level?.title ?? path ?? name ?? "Level"} – editor`;
});

// What another window or program has changed is seen when one comes back.
document.addEventListener("visibilitychange", () => {
  if (document.visibilityState === "visible") editor.send({ do: "state" });
});

window.addEventListener("beforeunload", (event) => {
  if (editor.state !== null && !editor.state.is_saved) event.preventDefault();
});
