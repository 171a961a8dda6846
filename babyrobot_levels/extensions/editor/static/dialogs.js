// Dialogs: what a level is opened from, the forms in which it is handed on, and its file.

import { html, prose, saveFile } from "../../../render/static/dom.js";
import { button, buttonRow } from "./html.js";
import { toolButton } from "./rail.js";

/** Return a modal dialog with a title; it closes with Escape, and by a button. */
export function dialogElement(title, ...content) {
  const made = html(
    "dialog",
    { "aria-label": title },
    html(
      "header",
      {},
      html("h2", {}, title),
      button("✕", { class: "close", "aria-label": "Close", onclick: () => made.close() }),
    ),
    ...content,
  );
  return made;
}

/** Save the text as a file of the browser's downloads. Returns whether that is known to Python. */
async function download(editor) {
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
  constructor(editor, place, root) {
    this.editor = editor;
    const opening = new OpenDialog(editor);
    const copying = new CopyDialog(editor);
    this.conflict = new ConflictDialog(editor);
    this.leaving = new LeaveDialog(editor, () => this.save());
    place.append(
      toolButton({ title: "Open another level", named: "Open", icon: "M3 19V6h6l2 2h8v3M3 19l3-8h16l-3 8z" }, () =>
        opening.show(),
      ),
      toolButton({ title: "Copy or download", named: "Copy", icon: "M9 9h11v11H9zM5 15H4V4h11v1" }, () =>
        copying.show(),
      ),
      toolButton({ title: "Save (Ctrl+S)", named: "Save", icon: "M5 4h11l4 4v12H5zM8 4v5h7V4M8 20v-6h8v6" }, () =>
        this.save(),
      ),
    );
    if (editor.connection.ends) {
      place.append(
        toolButton({ title: "End the editor", named: "End", icon: "M12 3v9M6.3 7a8 8 0 1 0 11.4 0" }, () =>
          this.leave(),
        ),
      );
    }
    root.append(...[opening, copying, this.conflict, this.leaving].map(({ dialog }) => dialog));
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
    if (unsaved) this.leaving.show();
  }
}

/** A level by its name, from a file, or from a text. */
class OpenDialog {
  constructor(editor) {
    this.editor = editor;
    this.filter = html("input", {
      type: "search",
      "aria-label": "Name of the level",
      placeholder: "Search",
      oninput: () => this.sift(),
    });
    this.list = html("ul", { class: "levels" });
    this.file = html("input", { type: "file", "aria-label": "File", onchange: () => this.read() });
    this.source = html("textarea", {
      rows: "5",
      spellcheck: "false",
      "aria-label": "Text or share code",
      placeholder: "A share code, the text of a level, or a map of another program, such as FrozenLake",
    });
    this.format = html("select", { "aria-label": "Format" });
    this.error = html("p", { class: "field-error", role: "alert" });
    this.dialog = dialogElement(
      "Open a level",
      html("h3", {}, "By name"),
      this.filter,
      this.list,
      html("h3", {}, "From a file"),
      this.file,
      html("h3", {}, "From a text"),
      this.source,
      buttonRow(
        this.format,
        button("Open the text", { class: "chief", onclick: () => this.open(this.source.value, this.format.value) }),
      ),
      this.error,
      html("p", { class: "field-help" }, "It takes the place of the level at hand. Undo brings that back."),
    );
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

const COPY_FORMS = [
  ["yaml", "Level file", "The text as it is."],
  ["drawing", "Drawing", "The grid in characters, as `Level.draw` gives it."],
  ["python", "Python", "A call that makes the level."],
  ["code", "Share code", "`brl.load` takes it, and so do the commands."],
  ["link", "Link", "Add it to the address of a page that `babyrobot preview LEVEL -o page.html` has made."],
];

/** The level in the forms in which it is handed on. */
class CopyDialog {
  constructor(editor) {
    this.editor = editor;
    this.forms = COPY_FORMS.map(([form, title]) =>
      button(title, { "data-form": form, onclick: () => this.choose(form) }),
    );
    this.shown = html("textarea", {
      class: "copied",
      rows: "12",
      readonly: true,
      wrap: "off",
      "aria-label": "What is copied",
    });
    this.help = html("p", { class: "field-help" });
    this.error = html("p", { class: "field-error", role: "alert" });
    this.copied = html("span", { role: "status" });
    this.download = button("Download", { onclick: () => download(editor) });
    this.dialog = dialogElement(
      "Copy the level",
      html("div", { class: "choices", role: "group", "aria-label": "Form" }, ...this.forms),
      this.shown,
      this.error,
      this.help,
      buttonRow(button("Copy", { class: "chief", onclick: () => this.copy() }), this.download, this.copied),
    );
  }

  show() {
    this.dialog.showModal();
    this.choose("yaml");
  }

  async choose(form) {
    const { address } = this.editor.connection;
    for (const each of this.forms) each.ariaPressed = String(each.dataset.form === form);
    const isOurs = form === "link" && address !== undefined;
    const help = isOurs ? "It opens the level in this editor." : COPY_FORMS.find(([name]) => name === form)[2];
    this.help.replaceChildren(...prose(help));
    this.copied.textContent = "";
    this.download.toggleAttribute("hidden", form !== "yaml");
    const { copy = "", error = "" } = await this.editor.send({ do: "copy", form: isOurs ? "code" : form });
    this.shown.value = isOurs && error === "" ? `${address}#${copy}` : copy;
    this.shown.classList.toggle("one-line", form === "code" || form === "link");
    this.error.replaceChildren(...prose(error));
  }

  async copy() {
    this.shown.select();
    try {
      await navigator.clipboard.writeText(this.shown.value);
    } catch {
      document.execCommand("copy"); // Pages that are not from this machine have no clipboard.
    }
    this.copied.textContent = "Copied.";
  }
}

/** The file was changed by another program: which text shall stay. */
class ConflictDialog {
  constructor(editor) {
    this.editor = editor;
    this.message = html("p", {});
    const pane = (title) =>
      html("textarea", { class: "copied", rows: "14", readonly: true, wrap: "off", "aria-label": title });
    this.ours = pane("Here");
    this.theirs = pane("In the file");
    this.both = html(
      "div",
      { class: "both" },
      html("div", {}, html("h3", {}, "Here"), this.ours),
      html("div", {}, html("h3", {}, "In the file"), this.theirs),
    );
    this.compare = button("Show both", { onclick: () => this.both.toggleAttribute("hidden") });
    this.reload = button("Take the file's text", { onclick: () => this.decide({ do: "reload" }) });
    this.dialog = dialogElement(
      "The file has changed",
      this.message,
      this.both,
      buttonRow(
        button("Overwrite the file", { class: "chief", onclick: () => this.decide({ do: "save", force: true }) }),
        this.reload,
        this.compare,
      ),
    );
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

/** There are changes that are not saved. */
class LeaveDialog {
  constructor(editor, save) {
    this.editor = editor;
    this.save = save;
    this.dialog = dialogElement(
      "End the editor?",
      html("p", {}, "The level has changes that are not saved."),
      buttonRow(
        button("Save and end", { class: "chief", onclick: () => this.saveAndEnd() }),
        button("End without saving", { onclick: () => editor.send({ do: "quit", force: true }) }),
        button("Go on editing", { onclick: () => this.dialog.close() }),
      ),
    );
  }

  show() {
    this.dialog.showModal();
  }

  async saveAndEnd() {
    this.dialog.close();
    if (await this.save()) await this.editor.send({ do: "quit", force: true });
  }
}
