// An example of a page that is changed in its place: its text, its picture, and what is found in it.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { Answers } from "./answers.js";
import { Editor } from "./editor.js";
import { Findings } from "./findings.js";
import { shadow } from "./html.js";
import { FIRST_TIME, Python, PythonConnection, STARTING } from "./python.js";
import { Stage } from "./stage.js";
import { TextPane } from "./text_pane.js";

let python = null; // All examples of a page have the same.

/** Let a text be changed in an element; `hear` gets each text that comes of it. */
async function show(place, text, hear) {
  python ??= new Python();
  const connection = new PythonConnection(python, text, "example");
  const begun = connection.begin();
  const style = await (await fetch(new URL("editor.css", import.meta.url))).text();
  const root = shadow(place, style, COMMON.example);
  const find = (name) => root.querySelector(`.${name}`);
  const editor = new Editor(connection);
  connection.editor = editor;
  new Answers(editor, find("answers"));
  const { notice } = new Stage(editor, find("stage"), find("map"), find("notice"));
  new Findings(editor, find("findings"), html("button", {})); // All is said below the picture.
  const { area } = new TextPane(editor, find("file"));
  editor.on("said", () => (find("said").textContent = editor.said));
  editor.on("state", () => hear(editor.state.text));
  notice.textContent = `${STARTING} ${FIRST_TIME}`;
  begun.catch((error) => (notice.textContent = error.message));
  await editor.send({ do: "state" });
  area.focus();
}

export default { show };
