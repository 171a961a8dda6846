// What is wrong with the level, or could be better: a list that leads to the places.

import { html, prose } from "./html.js";

const SIGNS = { error: "✕", warning: "!", info: "i" };

export class Findings {
  constructor(editor, place) {
    this.editor = editor;
    this.heading = html("h2", {});
    this.list = html("ul", { class: "finding-list" });
    place.append(this.heading, this.list);
    editor.on("state", () => this.show());
  }

  show() {
    const { findings, findings_pending: hasMore } = this.editor.state;
    const key = JSON.stringify([findings, hasMore]);
    if (key === this.key) return; // The focus stays where it is.
    this.key = key;
    const told = findings.length === 0 ? "No findings" : `Findings (${findings.length})`;
    this.heading.textContent = hasMore ? `${told} …` : told;
    this.heading.title = hasMore ? "The rules that take longer are checked when you pause." : "";
    this.list.replaceChildren(...findings.map((finding) => this.item(finding)));
  }

  item(finding) {
    const { code, severity, title, message, help, line } = finding;
    const said = html(
      "span",
      { class: "finding-text" },
      html("span", { class: "finding-message" }, ...prose(message)),
      help === null ? null : html("span", { class: "finding-help" }, ...prose(help)),
      html("span", { class: "finding-code" }, `${code} · line ${line}`),
    );
    const sign = html("span", { class: "sign", role: "img", "aria-label": severity }, SIGNS[severity]);
    const place = html(
      "button",
      { type: "button", class: "finding", title, onclick: () => this.goTo(finding) },
      sign,
      said,
    );
    const state = finding.is_outdated ? `${severity} outdated` : severity;
    return html("li", { class: state }, place, finding.fix === null ? null : this.fixButton(finding));
  }

  fixButton({ code, line, column, fix: { message, safe } }) {
    return html(
      "button",
      {
        type: "button",
        class: "fix",
        title: message,
        "aria-label": `Fix: ${message}${safe ? "" : " (changes the level)"}`,
        onclick: () => this.editor.send({ do: "fix", code, line, column }),
      },
      "Fix",
      safe ? null : html("small", {}, "changes the level"),
    );
  }

  /** Show the cell of a finding in the picture, and its place in the text. */
  goTo({ line, column, cells = [], sides = [] }) {
    const [[x, y, side] = []] = [...sides, ...cells];
    if (x !== undefined) this.editor.set("cursor", { cursor: { cell: [x, y], side: side ?? null } });
    this.editor.set("caret", { caret: { line, column } });
  }
}
