// What is wrong with the level, or could be better: a list that leads to the places.

import { html, prose } from "../../../render/static/dom.js";
import { button } from "./html.js";

const SIGNS = { error: "✕", warning: "!", info: "i" };

export class Findings {
  constructor(editor, place, problem) {
    this.editor = editor;
    this.problem = problem;
    this.heading = html("h2", {});
    this.list = html("ul", { class: "finding-list" });
    this.lacking = html("p", { class: "lacking" }, "Rules of play are not checked: they need the exact tables.");
    place.append(this.heading, this.list, this.lacking);
    editor.on("state", () => this.show());
  }

  show() {
    const { findings, findings_pending: hasMore, lacks } = this.editor.state;
    this.lacking.hidden = lacks === "";
    const key = JSON.stringify([findings, hasMore]);
    if (key === this.key) return; // The focus stays where it is.
    this.key = key;
    this.showProblem();
    const told = findings.length === 0 ? "No findings" : `Findings (${findings.length})`;
    this.heading.textContent = hasMore ? `${told} …` : told;
    this.heading.title = hasMore ? "The rules that take longer are checked when you pause." : "";
    this.list.replaceChildren(...findings.map((finding) => this.item(finding)));
  }

  /** Say over the board what is wrong with a text that has no picture; it leads to the place. */
  showProblem() {
    const [first, ...others] = this.editor.state.findings.filter(({ severity }) => severity === "error");
    this.problem.hidden = first === undefined;
    if (first === undefined) return;
    const { line, message, help } = first;
    const more = others.length === 0 ? "" : `, and ${others.length} more`;
    this.problem.onclick = () => this.goTo(first);
    this.problem.replaceChildren(
      html("strong", {}, `Error in line ${line}${more}`),
      html("span", {}, ...prose(message)),
      html("span", { class: "finding-help" }, ...prose(help ?? "")),
    );
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
    const place = button(sign, { class: "finding", title, onclick: () => this.goTo(finding) });
    place.append(said);
    const state = finding.is_outdated ? `${severity} outdated` : severity;
    return html("li", { class: state }, place, finding.fix === null ? null : this.fixButton(finding));
  }

  fixButton({ code, line, column, fix: { message, safe } }) {
    const label = `Fix: ${message}${safe ? "" : " (changes the level)"}`;
    const onclick = () => this.editor.send({ do: "fix", code, line, column });
    const made = button("Fix", { class: "fix", title: message, "aria-label": label, onclick });
    if (!safe) made.append(html("small", {}, "changes the level"));
    return made;
  }

  /** Show the cell of a finding in the picture, and its place in the text. */
  goTo({ line, column, cells = [], sides = [] }) {
    const [[x, y, side] = []] = [...sides, ...cells];
    if (x !== undefined) this.editor.set("cursor", { cursor: { cell: [x, y], side: side ?? null } });
    this.editor.set("caret", { caret: { line, column } });
  }
}
