// The editor as a site: its messages go to Python in a worker of this browser.

import { FIRST_TIME, Python, PythonConnection, STARTING } from "./python.js";
import { fillWindow } from "./window.js";

const KEPT = `babyrobot-editor ${location.pathname}`;

const given = JSON.parse(document.querySelector("#begin").textContent);
const connection = new PythonConnection(new Python(), ...beginning());

/** Return the text to begin with, and its name: what was kept here, or what the site begins with. */
function beginning() {
  let kept = null;
  try {
    kept = JSON.parse(localStorage.getItem(KEPT));
  } catch {}
  const { text, name } = typeof kept?.text === "string" ? kept : given;
  return /** @type {const} */ ([text, name]);
}

/** Keep the text in this browser. */
function keep() {
  const { text, name } = editor.state;
  try {
    localStorage.setItem(KEPT, JSON.stringify({ text, name }));
  } catch {
    editor.say("This browser keeps nothing for this page: save the level as a file.", "refused");
  }
}

/** Open the level of the address: a code, a name or a text after its `#`. */
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

const begun = connection.begin();
const editor = await fillWindow(connection);
connection.editor = editor;
const isKept = navigator.serviceWorker?.controller; // Nothing is loaded again.
editor.stage.notice.textContent = isKept ? STARTING : `${STARTING} ${FIRST_TIME}`;
begun.catch((error) => (editor.stage.notice.textContent = error.message));
editor.on("state", keep);
openAddress();
window.addEventListener("hashchange", openAddress);
begun.then(() => navigator.serviceWorker?.register("service.js"));
