// What lies on the picture while one edits: the preview of a gesture, selection, cursor, handles.

import { COMMON } from "../../../render/static/common.js";
import { element } from "../../../render/static/paint.js";
import { stamped } from "./region.js";
import { beyond, cornersOf, isSameCell, SIDE_NAMES, sidesOfRun } from "./spots.js";
import { isInside, sizeOf, toolNamed } from "./tools.js";

const TARGET = matchMedia("(pointer: coarse)").matches ? 44 : 28; // The side of what takes a handle, in pixels,
const WIND_TARGET = 26;
const RIM = 16; // and how far its middle is from the border.
const INSET = COMMON.cell / 8; // How far from their border the cells are outlined that a mover wanders in.
const CURSOR = COMMON.cell / 16; // And that of the cursor.
const STRONGEST_WIND = 3; // A click goes on from here to no wind.
const GRIPS = [-1, 0, 1].flatMap((dx) => [-1, 0, 1].map((dy) => [dx, dy])).filter(([dx, dy]) => dx !== 0 || dy !== 0);

export class Overlay {
  constructor(editor, stage) {
    this.editor = editor;
    this.stage = stage;
    this.filled = null; // What a fill would paint, as Python told last.
    for (const event of ["state", "selection", "cursor", "tool", "mode", "zoom"]) editor.on(event, () => this.show());
  }

  show() {
    if (!this.editor.game) return;
    const isEditing = this.editor.mode === "edit";
    this.draw("links", isEditing ? this.links() : []);
    this.draw("selected", isEditing ? this.selected() : []);
    this.draw("cursor", isEditing ? this.cursor() : []);
    this.draw("handles", isEditing && this.editor.state.is_valid ? this.handles() : []);
    this.preview(null);
  }

  draw(name, shapes) {
    this.stage.layer(name).replaceChildren(...shapes);
  }

  /** Show what a message would do, and where the pointer is; null shows nothing. */
  preview(message, spot = null) {
    this.previewed = message;
    this.editor.stage.place.dataset.preview = message?.do ?? "";
    const shapes = {
      walls: (each) => this.previewOfWalls(each),
      paint: (each) => this.previewOfPaint(each),
      fill: (each) => this.previewOfFill(each),
      move: ({ from, to }) => [...this.arrow([from, to]), ...this.boxes([to], "build")],
      warp: ({ at, to }) => [...this.arrow([at, to]), ...this.boxes([to], "build")],
      robot: ({ at, to }) =>
        to === undefined ? this.brushed("robot", [at]) : [...this.arrow([at, to]), ...this.boxes([to], "build")],
      path: ({ cells, rectangle }) => (rectangle ? this.rectangle(cells, "build") : this.arrow(cells)),
      resize: (each) => this.previewOfSize(each),
      lift: ({ cells }) => this.rectangle(cells, "build"),
      stamp: (each) => this.previewOfStamp(each),
      wind: () => [],
    };
    this.draw("preview", message === null ? [] : shapes[message.do](message, spot));
  }

  previewOfWalls(run) {
    if (!isInside(this.editor, beyond(run.at, run.side))) return [];
    const lines = sidesOfRun(run).map((side) => this.line(...side));
    return this.outlined(lines.join(""), run.to === "none" ? "remove" : "build", "wall");
  }

  previewOfPaint({ brush, cells, rectangle }) {
    return rectangle ? this.rectangle(cells, kindOf(brush)) : this.brushed(brush, cells);
  }

  /** Return the cells that are filled, which Python is asked for: at first the one at hand. */
  previewOfFill({ brush, at }) {
    const { revision } = this.editor.state;
    const known = this.filled;
    const isSame = known?.revision === revision && known.brush === brush;
    if (!isSame || ![known.at, ...known.cells].some((cell) => isSameCell(cell, at))) {
      this.filled = { revision, brush, at, cells: [] };
      this.askForFill(this.filled);
    }
    const cells = this.filled.cells.map((cell) => boxPath(this.box(cell))).join("");
    return [element("path", { d: cells, class: `ghost ${kindOf(brush)}` }), ...this.brushed(brush, [at])];
  }

  async askForFill(asked) {
    const { cells = [] } = await this.editor.ask({ do: "filled", brush: asked.brush, at: asked.at });
    asked.cells = cells;
    if (this.filled === asked && this.previewed?.do === "fill") this.preview(this.previewed);
  }

  previewOfStamp(stamp) {
    const { region } = this.editor;
    const outline = boxPath(this.box(stamp.at, region.size));
    return [stamped(region, stamp, this.corner(...stamp.at)), ...this.outlined(outline, "build")];
  }

  /** Return the rectangle between two corners. */
  rectangle(cells, kind) {
    const [[left, top], [right, bottom]] = cornersOf(cells);
    const box = this.box([left, top], [right - left + 1, bottom - top + 1]);
    return [element("rect", { ...box, class: `ghost ${kind}` }), ...this.outlined(boxPath(box), kind)];
  }

  /** Return cells with the icon of a brush. */
  brushed(brush, cells) {
    const kind = kindOf(brush);
    return [...this.boxes(cells, kind), ...cells.flatMap((cell) => this.icon(toolNamed(brush).icon, cell))];
  }

  icon(path, cell) {
    const [x, y] = this.corner(...cell);
    const scale = COMMON.cell / 48;
    const transform = `translate(${x + 12 * scale} ${y + 12 * scale}) scale(${scale})`;
    return ["under", "over"].map((name) => element("path", { d: path, transform, class: `sign ${name}` }));
  }

  boxes(cells, kind) {
    return cells.flatMap((cell) => {
      const box = this.box(cell);
      return [
        element("rect", { ...box, class: `ghost ${kind}` }),
        ...(cells.length === 1 ? this.outlined(boxPath(box), kind) : []),
      ];
    });
  }

  arrow(cells) {
    const middles = cells.map(([x, y]) => this.corner(x + 0.5, y + 0.5));
    const [[fromX, fromY], [toX, toY]] = middles.slice(-2);
    const turn = (Math.atan2(toY - fromY, toX - fromX) * 180) / Math.PI;
    const head = element("path", {
      d: "M0 0L-16 -9V9z",
      transform: `translate(${toX} ${toY}) rotate(${turn})`,
      class: "head",
    });
    return [...this.outlined(`M${middles.map((each) => each.join(" ")).join("L")}`, "build"), head];
  }

  previewOfSize({ size: [width, height], shift: [dx, dy] }) {
    const box = this.box([-dx, -dy], [width, height]);
    return [
      ...this.outlined(boxPath(box), "build"),
      this.label(`${width} × ${height}`, [box.x + box.width / 2, box.y + box.height / 2]),
    ];
  }

  /** Return words on a plate around a point, of the same size at any zoom. */
  label(words, [x, y]) {
    const [wide, high] = [9.3 * words.length + 12, 23];
    return element(
      "g",
      { transform: `translate(${x} ${y}) scale(${this.stage.unit})`, class: "label" },
      element("rect", { x: -wide / 2, y: -high / 2, width: wide, height: high, rx: 6 }),
      element("text", { y: 5.4, "text-anchor": "middle", "font-size": 15 }, words),
    );
  }

  /** Return the ways of movers, and lines from things to the doors and exits that need them. */
  links() {
    const { places, fields } = this.editor.state;
    const of = (name) => places.filter(({ kind }) => kind === name);
    const uses = ({ kind, fields: { needs, unless } }) => (kind === "exit" ? [fields.exit_needs] : [needs, unless]);
    const lines = ["item", "switch", "target"]
      .flatMap(of)
      .flatMap((from) =>
        [...of("door"), ...of("exit")]
          .filter((to) => uses(to).flat().includes(from.label))
          .map((to) => `M${this.middle(from)}L${this.middle(to)}`),
      );
    const ways = of("mover").map((mover) => this.way(mover));
    return [...this.outlined(ways.join(""), "link"), ...this.outlined(lines.join(""), "link", "needed")];
  }

  /** Return the way of a mover: through its cells, or around those that it wanders in. */
  way({ cells, fields: { within, back } }) {
    if (!within)
      return `M${cells.map(([x, y]) => this.corner(x + 0.5, y + 0.5).join(" ")).join("L")}${back ? "" : "z"}`;
    return boxPath(inset(this.box(within.at, within.size), INSET));
  }

  /** Return the middle of an entry, which may stand at sides. */
  middle({ cells, sides }) {
    const [x, y, side] = sides[Math.floor(sides.length / 2)] ?? cells[0];
    return this.corner(x + (side === "E" ? 1 : 0.5), y + (side === "S" ? 1 : 0.5)).join(" ");
  }

  selected() {
    const { selection } = this.editor;
    if (selection === null) return [];
    const cells = selection.cells.map((cell) => boxPath(this.box(cell)));
    const sides = selection.sides.map(([x, y, side]) => this.line([x, y], side));
    return [...this.outlined(cells.join(""), "selection"), ...this.outlined(sides.join(""), "selection", "wall")];
  }

  cursor() {
    const { cell, side } = this.editor.cursor;
    if (!isInside(this.editor, cell)) return [];
    return this.outlined(
      boxPath(inset(this.box(cell), CURSOR)) + (side === null ? "" : this.line(cell, side)),
      "cursor",
    );
  }

  /** Return what can be dragged or clicked outside of the grid. */
  handles() {
    return this.editor.tool === "wind" ? this.winds() : this.grips();
  }

  /** How far handles are from the border, in cells. */
  get rim() {
    return (RIM * this.stage.unit) / COMMON.cell;
  }

  /** Return where handles are at the right and at the bottom, below the legend of the values. */
  ends() {
    const [width, height] = sizeOf(this.editor);
    const { margin } = this.editor.game.data;
    const legend = this.stage.view.size[1] - 2 * margin - height * COMMON.cell;
    return [width + this.rim, height + legend / COMMON.cell + this.rim];
  }

  grips() {
    const size = sizeOf(this.editor);
    const ends = this.ends();
    return GRIPS.map(([dx, dy]) => {
      const at = [dx, dy].map((way, axis) => (way === 0 ? size[axis] / 2 : way < 0 ? -this.rim : ends[axis]));
      const shape = dx * dy !== 0 ? "M-5 -5h10v10h-10z" : dx === 0 ? "M-12 -3.5h24v7h-24z" : "M-3.5 -12h7v24h-7z";
      const data = { class: "grip", "data-handle": "size", "data-way": `${dx} ${dy}` };
      return this.handle(at, data, TARGET, element("path", { d: shape }));
    });
  }

  /** Return what is taken around a point in cells, of the same size at any zoom. */
  handle(at, data, side, ...shapes) {
    const [x, y] = this.corner(...at);
    const transform = `translate(${x} ${y}) scale(${this.stage.unit})`;
    const target = element("rect", { x: -side / 2, y: -side / 2, width: side, height: side, class: "target" });
    return element("g", { ...data, transform }, target, ...shapes);
  }

  winds() {
    const [width, height] = sizeOf(this.editor);
    const [right, bottom] = this.ends();
    const { rim } = this;
    const arrows = (count, side, at) =>
      Array.from({ length: count }, (_, index) => this.wind(side, index, at(index + 0.5)));
    return [
      ...arrows(width, "N", (along) => [along, -rim]),
      ...arrows(width, "S", (along) => [along, bottom]),
      ...arrows(height, "W", (along) => [-rim, along]),
      ...arrows(height, "E", (along) => [right, along]),
    ];
  }

  wind(side, index, at) {
    const strength = this.strengthOf(side, index);
    const turn = 90 * "NESW".indexOf(side);
    const data = { "data-handle": "wind", "data-side": side, "data-index": index };
    const shapes = [element("path", { d: "M0 -10l9 9h-5v8h-8v-8h-5z", transform: `rotate(${turn})` })];
    if (strength > 0)
      shapes.push(element("text", { y: 4, "text-anchor": "middle", "font-size": 11 }, String(strength)));
    return this.handle(at, { class: `wind ${strength > 0 ? "on" : ""}`, ...data }, WIND_TARGET, ...shapes);
  }

  strengthOf(side, index) {
    return this.editor.state.fields?.wind?.[SIDE_NAMES[side]]?.[index] ?? 0;
  }

  /** Return the gesture of a handle, as a function from spots to its message. */
  gestureOf({ dataset }, isLess) {
    if (dataset.handle === "wind") {
      const [side, index] = [dataset.side, Number(dataset.index)];
      const change = isLess ? STRONGEST_WIND : 1;
      const strength = (this.strengthOf(side, index) + change) % (STRONGEST_WIND + 1);
      return () => ({ do: "wind", side, index, strength });
    }
    const ways = dataset.way.split(" ").map(Number);
    const size = sizeOf(this.editor);
    return (spots) =>
      resized(size, ways, isClick(spots) ? ways.map((way) => Math.abs(way) * (isLess ? -1 : 1)) : added(ways, spots));
  }

  /** Return a path of strokes, dark below and bright above, which are seen on any colours. */
  outlined(path, kind, more = "") {
    return ["under", "over"].map((name) => element("path", { d: path, class: `stroke ${name} ${kind} ${more}` }));
  }

  line([x, y], side) {
    const ends = { N: [0, 0, 1, 0], E: [1, 0, 1, 1], S: [0, 1, 1, 1], W: [0, 0, 0, 1] }[side];
    const [from, to] = [this.corner(x + ends[0], y + ends[1]), this.corner(x + ends[2], y + ends[3])];
    return `M${from.join(" ")}L${to.join(" ")}`;
  }

  /** Return a rectangle of cells in the picture. */
  box([x, y], [columns, rows] = [1, 1]) {
    const [left, top] = this.corner(x, y);
    return { x: left, y: top, width: columns * COMMON.cell, height: rows * COMMON.cell };
  }

  corner(x, y) {
    return this.editor.game.corner(x, y);
  }
}

function kindOf(brush) {
  return brush === "erase" ? "remove" : "build";
}

function boxPath({ x, y, width, height }) {
  return `M${x} ${y}h${width}v${height}h${-width}z`;
}

/** Return a box that is smaller at all sides. */
function inset({ x, y, width, height }, by) {
  return { x: x + by, y: y + by, width: width - 2 * by, height: height - 2 * by };
}

/** Return whether a pointer stayed where it was pressed. */
function isClick(spots) {
  const [x, y] = spots[0].at;
  return spots.every(({ at }) => Math.hypot(at[0] - x, at[1] - y) < 0.15);
}

/** Return how many columns and rows a border that is dragged adds; `ways` says which border. */
function added(ways, spots) {
  const [first, last] = [spots[0].at, spots.at(-1).at];
  return ways.map((way, axis) => (way === 0 ? 0 : Math.round(way * (last[axis] - first[axis]))));
}

/** Return the message that adds columns and rows beyond a border, or removes them. */
function resized(size, ways, counts) {
  const added = counts.map((count, axis) => Math.max(1 - size[axis], count));
  if (added.every((count) => count === 0)) return null;
  return {
    do: "resize",
    size: size.map((length, axis) => length + added[axis]),
    shift: ways.map((way, axis) => (way < 0 ? added[axis] : 0)),
  };
}
