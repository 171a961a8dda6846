// The editor in a place of a document: a shadow root, so that styles neither leave nor enter it.

import { COMMON } from "../../../render/static/common.js";
import { prose } from "../../../render/static/dom.js";
import { ZOOM_STEP } from "../../../render/static/view.js";
import { Announcer } from "./announce.js";
import { Answers, offerSets } from "./answers.js";
import { Bar, Panels } from "./bar.js";
import { FileButtons } from "./dialogs.js";
import { Divider } from "./divider.js";
import { Editor } from "./editor.js";
import { Findings } from "./findings.js";
import { Help } from "./help.js";
import { shadow } from "./html.js";
import { Inspector } from "./inspector.js";
import { KeyBindings } from "./keys.js";
import { LearningPanel } from "./learning.js";
import { MarksOverlay } from "./marks_layer.js";
import { Offers } from "./maze.js";
import { Overlay } from "./overlay.js";
import { Playing } from "./playing.js";
import { Pointer } from "./pointer.js";
import { PolicyDrawing } from "./policy.js";
import { Options, Rail } from "./rail.js";
import { Stage } from "./stage.js";
import { TextPane } from "./text_pane.js";
import { Fingers } from "./touch.js";
import { World } from "./world.js";

/**
 * Show an editor in an element.
 *
 * `connection.send(message)` returns a promise of the reply. It may have `ends`, whether the other
 * side can be ended; `place`, where a level without a file is kept; `address`, of a page that opens
 * the code after its `#`; `earlier`, levels that were edited here before, each with its `title` and
 * `text`; and `more`, what can be loaded where there are no tables: its `title`, where it is `from`,
 * and `load`. `style` is the style sheet.
 */
export function mount(place, connection, style = "") {
  const root = shadow(place, style, COMMON.frame);
  const find = (name) => root.querySelector(`.${name}`);
  const editor = new Editor(connection);
  new Answers(editor, find("answers"));
  const stage = new Stage(editor, find("stage"), find("map"), find("notice"));
  new MarksOverlay(editor, find("view"));
  const overlay = new Overlay(editor, stage);
  editor.pointer = new Pointer(editor, stage, overlay);
  new Fingers(stage, editor.pointer);
  new Announcer(editor, find("spoken"));
  new Playing(editor, find("playing"));
  new PolicyDrawing(editor, find("policy"));
  const sets = offerSets(editor, find("answers"));
  new Rail(editor, find("tools"));
  new Options(editor, find("options"), find("tools"));
  new Bar(editor, find("bar"));
  new Panels(editor, find("tabs"), find("panels"));
  const zooms = [() => stage.view.zoomBy(1 / ZOOM_STEP), () => stage.view.fit(), () => stage.view.zoomBy(ZOOM_STEP)];
  [...find("zoom").children].forEach((each, index) => (each.onclick = () => editor.game && zooms[index]()));
  new LearningPanel(editor, root, find("algorithm"), sets);
  new Divider(find("editor"), find("panels"));
  new Inspector(editor, find("inspector"));
  new World(editor, find("world"));
  new Offers(editor, find("below"));
  new Findings(editor, find("findings"), find("problem"));
  new TextPane(editor, find("file"));
  new FileButtons(editor, find);
  new Help(editor, find("help"), new KeyBindings(editor, root, overlay));
  root.addEventListener("click", (/** @type {any} */ { target }) => {
    const asked = target.closest("[data-do]");
    if (asked !== null) editor.send({ do: asked.dataset.do });
    target.closest(".close")?.closest("dialog").close();
  });
  editor.on("said", () => {
    find("said").replaceChildren(...prose(editor.said));
    find("said").dataset.kind = editor.saidKind;
  });
  editor.on(
    "pointed",
    () => (find("pointed").textContent = editor.pointed === null ? "" : `[${editor.pointed.join(", ")}]`),
  );
  editor.on("state", () => (find("editor").dataset.revision = editor.state.revision));
  editor.on("mode", () => (find("editor").dataset.mode = editor.mode));
  editor.send({ do: "state" });
  return editor;
}
