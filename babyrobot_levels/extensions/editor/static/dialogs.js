// Dialogs: what a level is opened from, the forms in which it is handed on, and its file.

import { copyText, html, prose, saveFile } from "../../../render/static/dom.js";
import { button, finder } from "./html.js";

/** Save the text as a file of the browser's downloads. Returns whether that is known to Python. */
async function download(editor) {
  await editor.last; // What was typed is in the state once it is answered.
  const { path, name, text } = editor.state;
  const file = path ?? `${name ?? "level"}.yaml`;
  saveFile(file, text);
  editor.say(`Downloaded as ${file}.`);
  if (path !== null) return true; // What is saved is the file's business.
  const { error } = await editor.send({ do: "downloaded" });
  return error === undefined;
}

/** The buttons of the bar that open, copy and save, and end the editor. */
export class FileButtons {
  constructor(editor, find) {
    this.editor = editor;
    const opening = new OpenDialog(editor, find("opening"));
    const copying = new CopyDialog(editor, find("copying"));
    this.conflict = new ConflictDialog(editor, find("conflict"));
    this.leaving = find("leaving");
    const leaving = finder(this.leaving);
    leaving(".chief").onclick = () => this.saveAndEnd();
    leaving(".force").onclick = () => editor.send({ do: "quit", force: true });
    leaving(".stay").onclick = () => this.leaving.close();
    const actions = {
      open: () => opening.show(),
      copy: () => copying.show(),
      save: () => this.save(),
      end: () => this.leave(),
      help: () => editor.tell("help"),
    };
    for (const each of find("files").children) {
      each.onclick = actions[each.dataset.file];
      if (each.dataset.file === "end") each.hidden = !editor.connection.ends;
    }
    editor.on("save", () => this.save());
  }

  /** Write the level to its file, or download it. Returns whether it is saved. */
  async save() {
    const { editor } = this;
    if (editor.state.path === null) return download(editor);
    const { error, conflict } = await editor.send({ do: "save" });
    if (conflict !== undefined) this.conflict.show(error, conflict);
    if (error === undefined) editor.say(`Saved to ${editor.state.path}.`);
    return error === undefined;
  }

  async leave() {
    const { unsaved } = await this.editor.send({ do: "quit" });
    if (unsaved) this.leaving.showModal();
  }

  async saveAndEnd() {
    this.leaving.close();
    if (await this.save()) await this.editor.send({ do: "quit", force: true });
  }
}

/** A level by its name, from a file, or from a text. */
class OpenDialog {
  constructor(editor, dialog) {
    this.editor = editor;
    this.dialog = dialog;
    const find = finder(dialog);
    this.filter = find("[type=search]");
    this.list = find("ul");
    this.file = find("[type=file]");
    this.source = find("textarea");
    this.format = find("select");
    this.error = find(".field-error");
    this.filter.oninput = () => this.sift();
    this.file.onchange = () => this.read();
    find(".chief").onclick = () => this.open(this.source.value, this.format.value);
  }

  async show() {
    this.error.replaceChildren();
    this.dialog.showModal();
    this.filter.focus();
    const { levels = [], formats = [] } = await this.editor.send({ do: "levels" });
    const { earlier = [] } = this.editor.connection;
    this.list.replaceChildren(
      ...earlier.map(({ title, name, text }) => this.item(title ?? name, "kept in this browser", text)),
      ...levels.map(({ name, title, size }) => this.item(title ?? name, `${name} · ${size.join(" × ")}`, name)),
    );
    this.format.replaceChildren(
      html("option", { value: "" }, "Recognise the format"),
      ...formats.map(({ name, title }) => html("option", { value: name }, title)),
    );
    this.sift();
  }

  item(title, about, source) {
    const shown = { class: "level", "data-about": about, onclick: () => this.open(source) };
    return html("li", { "data-search": `${title} ${about}`.toLowerCase() }, button(html("strong", {}, title), shown));
  }

  sift() {
    const sought = this.filter.value.trim().toLowerCase();
    for (const item of this.list.children) item.toggleAttribute("hidden", !item.dataset.search.includes(sought));
  }

  async read() {
    const [file] = this.file.files;
    if (file !== undefined) await this.open(await file.text());
    this.file.value = "";
  }

  async open(source, format = "") {
    const { error } = await this.editor.send({ do: "open", source, ...(format === "" ? {} : { format }) });
    if (error === undefined) this.dialog.close();
    else this.error.replaceChildren(...prose(error));
  }
}

/** The level in the forms in which it is handed on. */
class CopyDialog {
  constructor(editor, dialog) {
    this.editor = editor;
    this.dialog = dialog;
    const find = finder(dialog);
    this.forms = find(".choices").children;
    this.shown = find("textarea");
    this.help = find(".field-help");
    this.error = find(".field-error");
    this.copied = find("[role=status]");
    this.download = find(".download");
    this.download.onclick = () => download(editor);
    this.chief = find(".chief");
    this.chief.onclick = () => this.copy();
    for (const each of this.forms) each.onclick = () => this.choose(each);
  }

  show() {
    this.dialog.showModal();
    this.choose(this.forms[0]);
  }

  async choose(chosen) {
    const { address } = this.editor.connection;
    const { form, help } = chosen.dataset;
    for (const each of this.forms) each.ariaPressed = String(each === chosen);
    const isOurs = form === "link" && address !== undefined;
    this.help.replaceChildren(...prose(isOurs ? "It opens the level in this editor." : help));
    this.copied.textContent = "";
    this.download.toggleAttribute("hidden", form !== "yaml");
    const { copy = "", error = "" } = await this.editor.send({ do: "copy", form: isOurs ? "code" : form });
    this.shown.value = isOurs && error === "" ? `${address}#${copy}` : copy;
    this.shown.classList.toggle("one-line", form === "code" || form === "link");
    this.error.replaceChildren(...prose(error));
  }

  async copy() {
    await copyText(this.shown.value, this.chief);
    this.copied.textContent = "Copied.";
  }
}

/** The file was changed by another program: which text shall stay. */
class ConflictDialog {
  constructor(editor, dialog) {
    this.editor = editor;
    this.dialog = dialog;
    const find = finder(dialog);
    this.message = find("p");
    this.both = find(".both");
    this.ours = find("[aria-label=Here]");
    this.theirs = find("[aria-label='In the file']");
    this.reload = find(".reload");
    this.compare = find(".compare");
    this.reload.onclick = () => this.decide({ do: "reload" });
    this.compare.onclick = () => this.both.toggleAttribute("hidden");
    find(".chief").onclick = () => this.decide({ do: "save", force: true });
  }

  /** `content` is what the file holds now, null if it cannot be read. */
  show(message, { text: content }) {
    this.message.textContent = `${message}.`;
    this.ours.value = this.editor.state.text;
    this.theirs.value = content ?? "";
    this.both.setAttribute("hidden", "");
    for (const each of [this.compare, this.reload]) each.toggleAttribute("hidden", content === null);
    this.dialog.showModal();
  }

  async decide(message) {
    this.dialog.close();
    const { error } = await this.editor.send(message);
    if (error === undefined)
      this.editor.say(message.do === "save" ? "Saved." : "This is the text of the file. Undo brings the other back.");
  }
}
