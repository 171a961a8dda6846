// The legend: the rules of the level, and what is in the cell that is pointed at.

import { COMMON } from "./common.js";
import { html } from "./dom.js";
import { element, painterOf } from "./paint.js";

/** The list of rules, the line about one cell, and the outlines of cells in the picture. */
export class Legend {
  constructor(view, rules, line) {
    this.view = view;
    this.rules = rules;
    this.line = line;
    const { stage } = view;
    stage.addEventListener("pointermove", (event) => event.pointerType === "mouse" && this.point(event));
    stage.addEventListener("click", (event) => this.point(event));
    for (const name of ["pointerleave", "pointerdown", "scroll"]) {
      stage.addEventListener(name, () => this.leave());
    }
  }

  /** Show the rules of a game. */
  show(game) {
    const painter = painterOf(game.data.picture);
    this.game = game;
    this.all = (game.data.rules ?? []).map(([sample, words, runs]) => ({
      sample: painter.layer(sample),
      words,
      cells: cellsOf(runs, game.cells),
    }));
    this.outlines = element("path", { id: "outlines" });
    this.view.svg.append(this.outlines);
    this.rules.closest("details").hidden = this.all.length === 0;
    this.rules.replaceChildren(...this.all.map((rule) => this.item(rule)));
    this.leave();
  }

  /** Return a rule with its sample; those about cells show which, where they have the focus. */
  item({ words, sample, cells }) {
    const icon = element(
      "svg",
      {
        viewBox: `0 0 ${COMMON.cell} ${COMMON.cell}`,
        "aria-hidden": true,
        class: this.view.svg.querySelector("#ground").getAttribute("class") ?? undefined,
      },
      ...sample,
    );
    const [show, hide] = [() => this.outline(cells), () => this.outline([])];
    const shown = { onfocus: show, onpointerenter: show, onblur: hide, onpointerleave: hide };
    return html("li", {}, html(cells.length > 0 ? "button" : "span", shown, icon, words));
  }

  /** Return the number of the cell at a point of the window; -1 for none. */
  cellAt({ clientX, clientY }) {
    const { svg } = this.view;
    const { left, top, width } = svg.getBoundingClientRect();
    const { data } = this.game;
    const scale = svg.viewBox.baseVal.width / width;
    const [x, y] = [clientX - left, clientY - top].map((pixels) =>
      Math.floor((scale * pixels - data.margin) / COMMON.cell),
    );
    return x < 0 || y < 0 || x >= data.width || y >= data.height ? -1 : y * data.width + x;
  }

  /** Tell what is in the cell under the pointer. */
  point(event) {
    const cell = this.cellAt(event);
    if (cell < 0 || this.game.sight?.now.seen.has(cell) === false) {
      this.leave();
      return;
    }
    const isHere = this.all.map(({ cells }) => cells.includes(cell));
    const told = this.all.filter((_, index) => isHere[index]).map(({ words }) => words);
    const things = this.game.things.at(this.game.configuration, cell).map(({ name }) => name);
    this.line.textContent = [`[${this.game.place(cell).join(", ")}]`, ...things, ...told].join(" \u00b7 ");
    this.line.hidden = false;
    const frame = this.view.stage.getBoundingClientRect();
    this.line.classList.toggle("high", event.clientY > frame.top + frame.height / 2);
    [...this.rules.children].forEach((item, index) => item.classList.toggle("here", isHere[index]));
    this.outline([cell]);
  }

  leave() {
    this.line.hidden = true;
    for (const item of this.rules.children) item.classList.remove("here");
    this.outline([]);
  }

  /** Outline cells in the picture. */
  outline(cells) {
    const { sight } = this.game;
    const shown =
      sight === null ? cells : cells.filter((cell) => sight.now.seen.has(cell) || sight.now.before.has(cell));
    this.outlines.setAttribute("d", this.game.squares(shown.map((cell) => this.game.place(cell))));
  }
}

/** Return the cells of runs, each its first cell and its length. */
function cellsOf(runs, count) {
  const all = [];
  for (let at = 0; at + 1 < runs.length; at += 2) {
    const end = Math.min(count, runs[at] + runs[at + 1]);
    for (let cell = runs[at]; cell < end; cell++) all.push(cell);
  }
  return all;
}
