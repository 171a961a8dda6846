// The fog over cells that are not seen, and the shades of what may be.

import { COMMON } from "./common.js";
import { element } from "./paint.js";
import { inPercent, Sight } from "./sight.js";

const [FAINT, STRONG] = [0.25, 0.85]; // The opacities of shades of what is unlikely, and nearly certain.
const LINE = 13; // The height of a line of text.
const MOST_LINES = 4;

/** Have a game played through the sight of its page, if there is one. */
export function limitSight(game) {
  if (game.data.sight === undefined) return;
  game.sight = new Sight(game.data);
  game.sight.begin(game.state);
}

/** The layers of a picture that hide what a sight does not show. */
export class Fog {
  constructor(game, svg) {
    this.game = game;
    const known = element("clipPath", { id: "known" }, element("path", {}));
    // What was seen before: the ground alone, as things may have changed.
    const ground = element("use", { href: "#ground", "clip-path": "url(#known)" });
    this.remembered = element("g", { id: "remembered" }, known, ground, element("path", {}));
    this.unseen = element("path", { id: "fog" });
    this.shades = element("g", { id: "belief", class: "hidden" });
    if (game.sight !== null) svg.append(this.remembered, this.unseen, this.shades);
  }

  /** Show what is seen at the state at hand; all of it at the end of an episode. */
  stand() {
    const { sight, cells, end, things } = this.game;
    if (sight === null) return;
    const isOver = end !== null;
    for (const layer of [this.remembered, this.unseen]) layer.classList.toggle("hidden", isOver);
    const { seen, before } = sight.now;
    const all = [...Array(cells).keys()].filter((cell) => !seen.has(cell));
    const remembered = this.squares(all.filter((cell) => before.has(cell)));
    for (const path of this.remembered.querySelectorAll("path")) path.setAttribute("d", remembered);
    this.unseen.setAttribute("d", this.squares(all.filter((cell) => !before.has(cell))));
    const inCells = new Map();
    for (const place of isOver ? [] : sight.places(things)) {
      inCells.set(place[1], [...(inCells.get(place[1]) ?? []), place]);
    }
    this.shades.replaceChildren(...[...inCells].flatMap(([cell, found]) => this.shade(cell, found)));
  }

  squares(cells) {
    return this.game.squares(cells.map((cell) => this.game.place(cell)));
  }

  /** Return the shades of a cell in which things may be: of each, its name and its probability. */
  shade(cell, found) {
    const [x, y] = this.game.corner(...this.game.place(cell));
    const side = COMMON.cell;
    const most = Math.max(...found.map(([, , chance]) => chance));
    const lines = found.flatMap(([name, , chance]) => [name, inPercent(chance)]).slice(-MOST_LINES);
    return [
      element("rect", { x, y, width: side, height: side, opacity: FAINT + (STRONG - FAINT) * most }),
      ...lines.map((line, at) =>
        element("text", { x: x + side / 2, y: y + side / 2 + LINE * (at + 0.8 - lines.length / 2) }, line),
      ),
    ];
  }
}
