// The bar: what is open and whether it is saved, undo and redo, and the mode.

import { listenToArrows, markChosen } from "../../../render/static/steps.js";
import { finder } from "./html.js";

const OWN_PANELS = ["algorithm", "file"]; // They stay while one draws, whatever is selected.

export class Bar {
  constructor(editor, place) {
    this.editor = editor;
    const find = finder(place);
    this.name = find(".name");
    this.file = find(".file-state");
    this.undo = find("[data-do=undo]");
    this.redo = find("[data-do=redo]");
    this.modes = find(".modes").children;
    for (const each of this.modes) each.onclick = () => editor.enter(each.dataset.mode);
    editor.on("state", () => this.showState());
    editor.on("mode", () => this.showMode());
    this.showMode();
  }

  showState() {
    const { state } = this.editor;
    this.name.textContent = state.level?.title ?? state.path ?? state.name ?? "Level";
    const file = state.path ?? this.editor.connection.place ?? "no file yet";
    const isNew = state.path !== null && !state.is_made;
    const saved = isNew ? `${file}, made when you save` : file;
    this.file.textContent = state.is_saved ? saved : `${file}, not saved`;
    this.file.classList.toggle("unsaved", !state.is_saved);
    this.undo.disabled = !state.can_undo;
    this.redo.disabled = !state.can_redo;
  }

  showMode() {
    for (const button of this.modes) button.setAttribute("aria-pressed", button.dataset.mode === this.editor.mode);
  }
}

/** The tabs of the panels: which one is shown. */
export class Panels {
  constructor(editor, tabs, panels) {
    this.editor = editor;
    this.panels = panels;
    this.tabs = [...tabs.children];
    for (const tab of this.tabs) tab.onclick = () => editor.set("panel", { panel: tab.dataset.panel });
    listenToArrows(tabs, (tab) => tab.click());
    editor.on("panel", () => this.show());
    editor.on("selection", () => {
      if (editor.selection !== null && !OWN_PANELS.includes(editor.panel)) editor.set("panel", { panel: "inspector" });
    });
    editor.on("state", () => {
      const count = editor.state.findings.length;
      const tab = this.tabs.find(({ dataset }) => dataset.panel === "findings");
      tab.dataset.count = count || "";
      tab.setAttribute("aria-label", `Findings: ${count}`);
    });
    this.show();
  }

  show() {
    const { panel } = this.editor;
    markChosen(
      this.tabs,
      this.tabs.find(({ dataset }) => dataset.panel === panel),
    );
    for (const each of this.panels.children) each.classList.toggle("shown", each.classList.contains(panel));
  }
}
