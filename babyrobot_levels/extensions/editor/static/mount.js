// The editor in a place of a document: a shadow root, so that styles neither leave nor enter it.

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
import { Options, Rail, toolButton } from "./rail.js";
import { Stage } from "./stage.js";
import { TextPane } from "./text_pane.js";
import { Fingers } from "./touch.js";
import { World } from "./world.js";

const LAYOUT = `
<div class="editor" data-mode="edit">
<section class="bar" data-part="bar" aria-label="Level and file">
<div class="title"></div>
<div class="modes choices" role="group" aria-label="Mode"></div>
<div class="history" role="group" aria-label="History"></div>
<div class="files" role="group" aria-label="File"></div>
</section>
<div class="tools" popover data-part="tools" role="toolbar" aria-label="Tools" aria-orientation="vertical"></div>
<section class="board" aria-label="Picture">
<div class="options"></div>
<div class="view">
<div class="stage" data-part="stage" tabindex="0" role="application" aria-roledescription="level editor" aria-labelledby="level-name" aria-describedby="alt keys-hint"></div>
<p class="unseen" id="keys-hint">The arrow keys move a cursor, and the question mark lists all keys.</p>
<svg class="map" aria-hidden="true" hidden><image/><path/><circle/><rect/></svg>
<p class="notice"></p>
<button type="button" class="problem" hidden></button>
</div>
<div class="playing" hidden></div>
<div class="policy" hidden></div>
<div class="below">
<p class="said" role="status" aria-live="polite"></p>
<p class="spoken unseen" role="status" aria-live="polite"></p>
<p class="pointed" aria-hidden="true"></p>
<div class="zoom" role="group" aria-label="Zoom"></div>
</div>
</section>
<section class="panels" data-part="panels" aria-label="Details">
<section class="answers"></section>
<div class="tabs" role="tablist" aria-label="Panels"></div>
<section class="inspector" data-tab="Selection"></section>
<section class="world" data-tab="Level"></section>
<section class="findings" data-tab="Findings"></section>
<section class="algorithm" data-tab="Learn"></section>
<section class="file" data-tab="Text"></section>
</section>
</div>
`;

/** @type {[string, string, (view: Stage["view"]) => void][]} */
const ZOOMS = [
  ["Zoom out", "M6 12h12", (view) => view.zoomBy(1 / ZOOM_STEP)],
  ["Show the whole level", "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5", (view) => view.fit()],
  ["Zoom in", "M6 12h12M12 6v12", (view) => view.zoomBy(ZOOM_STEP)],
];

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
  const root = shadow(place, style, LAYOUT);
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
  new Bar(editor, { title: find("title"), modes: find("modes"), history: find("history") });
  new Panels(editor, find("tabs"), find("panels"));
  find("zoom").append(
    ...ZOOMS.map(([title, icon, change]) => toolButton({ title, icon }, () => editor.game && change(stage.view))),
  );
  new LearningPanel(editor, root, find("algorithm"), sets);
  new Divider(find("editor"), find("panels"));
  new Inspector(editor, find("inspector"));
  new World(editor, find("world"));
  new Offers(editor, find("zoom").parentElement);
  new Findings(editor, find("findings"), find("problem"));
  new TextPane(editor, find("file"));
  new FileButtons(editor, find("files"), find("editor"));
  new Help(editor, find("files"), find("editor"), new KeyBindings(editor, root, overlay));
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
