// The bar: what is open and whether it is saved, undo and redo, and the mode.

import { html } from "../../../render/static/dom.js";
import { listenToArrows } from "../../../render/static/steps.js";
import { toolButton } from "./rail.js";

const MODES = [
  ["edit", "Edit"],
  ["play", "Play"],
  ["policy", "Policy"],
];

const OWN_PANELS = ["algorithm", "file"]; // They stay while one draws, whatever is selected.

export class Bar {
  constructor(editor, { title, modes, history }) {
    this.editor = editor;
    this.name = html("strong", { class: "name", id: "level-name", role: "heading", "aria-level": "1" });
    this.file = html("span", { class: "file-state" });
    title.append(this.name, this.file);
    this.modes = MODES.map(([mode, text]) => toolButton({ text, "data-mode": mode }, () => editor.enter(mode)));
    modes.append(...this.modes);
    this.undo = toolButton({ title: "Undo (Ctrl+Z)", icon: "M9 5L4 10l5 5M4 10h10a5.5 5.5 0 0 1 0 11h-3" }, () =>
      editor.send({ do: "undo" }),
    );
    this.redo = toolButton({ title: "Redo (Ctrl+Shift+Z)", icon: "M15 5l5 5-5 5M20 10H10a5.5 5.5 0 0 0 0 11h3" }, () =>
      editor.send({ do: "redo" }),
    );
    history.append(this.undo, this.redo);
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
    this.tabs = [...panels.querySelectorAll(":scope > [data-tab]")].map((panel) => {
      const name = panel.classList[0];
      const tab = toolButton({ text: panel.dataset.tab, role: "tab", "data-panel": name }, () =>
        editor.set("panel", { panel: name }),
      );
      panel.setAttribute("role", "tabpanel");
      panel.tabIndex = 0; // It is scrolled by keys.
      panel.setAttribute("aria-label", panel.dataset.tab);
      return tab;
    });
    tabs.append(...this.tabs);
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
    for (const tab of this.tabs) {
      const isShown = tab.dataset.panel === this.editor.panel;
      tab.setAttribute("aria-selected", isShown);
      tab.tabIndex = isShown ? 0 : -1;
      this.panels.querySelector(`:scope > .${tab.dataset.panel}`).classList.toggle("shown", isShown);
    }
  }
}
