// The editor as a site: its messages go to Python in a worker of this browser.

import { html, keepData, recalled } from "../../../render/static/dom.js";
import { FIRST_TIME, Python, PythonConnection, STARTING } from "./python.js";
import { fillWindow } from "./window.js";

const KEPT = `babyrobot-editor ${location.pathname}`;
const EARLIER = `${KEPT} earlier`;
const MOST_EARLIER = 5;

/** A session of which this browser keeps the text, and what was drawn before another level was opened. */
class KeptConnection extends PythonConnection {
  async send(message) {
    if (message.do === "open") this.remember();
    return super.send(message);
  }

  /** The levels that others took the places of, the last first. */
  get earlier() {
    return recalled(EARLIER) ?? [];
  }

  remember() {
    const kept = recalled(KEPT);
    if (!kept?.isOwn) return;
    const others = this.earlier.filter(({ text }) => text !== kept.text);
    keepData(EARLIER, [kept, ...others].slice(0, MOST_EARLIER));
  }
}

const given = JSON.parse(document.querySelector("#begin").textContent);
const beginning = recalled(KEPT) ?? given;
const connection = new KeptConnection(new Python(), beginning.text, beginning.name);

/** Keep the text in this browser, and whether anything was drawn or typed in it. */
function keep() {
  isThere = true;
  const { text, name, level, is_saved } = editor.state;
  const kept = recalled(KEPT);
  const isOwn = !is_saved || (kept?.text === text && kept.isOwn);
  if (!keepData(KEPT, { text, name, title: level?.title ?? name, isOwn }))
    editor.say("This browser keeps nothing for this page: save the level as a file.", "refused");
}

/** Keep the picture, for the next visit: it is there before Python is. */
function keepPicture() {
  const svg = editor.picture?.svg.cloneNode(true);
  for (const each of svg?.querySelectorAll(".hidden, .layers") ?? []) each.remove();
  const kept = recalled(KEPT);
  if (svg && kept !== null) keepData(KEPT, { ...kept, picture: new XMLSerializer().serializeToString(svg) });
}

/** Show the picture of the level that is to come, and how much of Python has been loaded. */
function showStart() {
  const { picture, text } = beginning.picture || beginning.text !== given.text ? beginning : given;
  if (picture && text === beginning.text && !location.hash) {
    const address = `data:image/svg+xml,${encodeURIComponent(picture)}`;
    editor.stage.place.append(html("img", { src: address, alt: "" }));
  }
  const isKept = navigator.serviceWorker?.controller; // Nothing is loaded again.
  const tell = (told) => isThere || (editor.stage.notice.textContent = `${STARTING} ${told}`);
  tell(isKept ? "" : FIRST_TIME);
  connection.python.onprogress = (bytes) => tell(`${(bytes / 1e6).toFixed(1)} of SITE_MEGABYTES MB`);
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

let isThere = false; // The level, in a picture that can be changed.
const begun = connection.begin();
const editor = await fillWindow(connection);
connection.editor = editor;
showStart();
window.addEventListener("pagehide", keepPicture);
begun.catch((error) => (editor.stage.notice.textContent = error.message));
editor.on("state", keep);
openAddress();
window.addEventListener("hashchange", openAddress);
begun.then(() => navigator.serviceWorker?.register("service.js"));
