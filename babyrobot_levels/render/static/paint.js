// Paints packed shapes as SVG: six kinds, each with its own attributes.

import { color, list, MOST_PLACES, MOST_SHAPES, need, text, whole } from "./checks.js";
import { COMMON } from "./common.js";

export const FONT = "Helvetica, Arial, 'Liberation Sans', sans-serif";
const ANCHORS = ["start", "middle", "end"];
const PLACES = { m: 2, l: 2, c: 6, z: 0 };

/**
 * Return an SVG element; attributes that are undefined are left out.
 *
 * @param {string} name
 * @param {Record<string, any>} attributes
 * @param {(Node | string)[]} children
 * @returns {SVGElement}
 */
export function element(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** Return tenths of a pixel as pixels. @param {number} tenths */
export function pixels(tenths) {
  return Math.round(tenths * 10) / 100;
}

/** Paints the layers of one picture. */
export class Painter {
  /** @param {string[]} palette @param {string[]} [scale] */
  constructor(palette, scale = []) {
    this.palette = palette;
    this.scale = scale;
    this.shapes = 0;
    this.places = 0;
  }

  /** Return the shapes of a layer as elements. @param {any} groups @returns {SVGElement[]} */
  layer(groups) {
    return list(groups).flatMap((group) => {
      const [x, y, shapes] = list(group, 3, 3);
      this.x = whole(x);
      this.y = whole(y);
      this.outline = null;
      this.count(list(shapes).length);
      return shapes.map((shape) => this.paint(list(shape, 9, 3)));
    });
  }

  /** @param {number} more */
  count(more) {
    this.shapes += more;
    need(this.shapes <= MOST_SHAPES);
  }

  /** @param {any[]} shape */
  paint([kind, fill, ...more]) {
    /** @type {((...more: any[]) => SVGElement)[]} */
    const kinds = [this.rect, this.ellipse, this.path, this.text, this.again, this.bar];
    return kinds[whole(kind, 0, kinds.length - 1)].call(this, this.color(fill), ...more);
  }

  // What a shape has, by its kind; each number is checked as it is used.

  rect(fill, x, y, width, height, opacity, radius = 0) {
    return element("rect", {
      x: this.left(x),
      y: this.top(y),
      width: extent(width),
      height: extent(height),
      rx: radius === 0 ? undefined : extent(radius),
      fill,
      opacity: share(opacity),
    });
  }

  ellipse(fill, x, y, rx, ry, opacity) {
    return element("ellipse", {
      cx: this.left(x),
      cy: this.top(y),
      rx: extent(rx),
      ry: extent(ry),
      fill,
      opacity: share(opacity),
    });
  }

  path(fill, commands, opacity, stroke = -1, width = 10, cap = 0, dash = 0, gap = 0) {
    this.outline = outline(text(commands), this.x, this.y);
    const isDrawn = stroke !== -1;
    return element("path", {
      d: this.written(this.outline),
      fill,
      stroke: isDrawn ? this.color(stroke) : undefined,
      "stroke-width": isDrawn ? extent(width) : undefined,
      "stroke-linecap": whole(cap, 0, 1) ? "round" : undefined,
      "stroke-dasharray": dash === 0 ? undefined : `${extent(dash)} ${extent(gap)}`,
      opacity: share(opacity),
    });
  }

  text(fill, x, y, words, size, anchor = 1, isBold = 0, opacity = undefined) {
    return element(
      "text",
      {
        x: this.left(x),
        y: this.top(y),
        "font-size": extent(size),
        "font-weight": whole(isBold, 0, 1) ? "bold" : undefined,
        "text-anchor": ANCHORS[whole(anchor, 0, 2)],
        fill,
        opacity: share(opacity),
      },
      text(words),
    );
  }

  again(fill, scale, x, y, opacity) {
    need(this.outline !== null);
    const middle = [this.x + whole(x), this.y + whole(y)];
    const times = whole(scale, 0, 1000000) / 1000;
    /** @type {any[]} */
    const scaled = this.outline.map(([letter, places]) => [
      letter,
      places.map((place, index) => middle[index % 2] + times * (place - middle[index % 2])),
    ]);
    return element("path", { d: this.written(scaled), fill, opacity: share(opacity) });
  }

  bar(_, x, y, width, height, first, last) {
    const [left, length, from, to] = [this.x + whole(x), whole(width, 0), whole(first), whole(last)];
    this.count(COMMON.bar);
    return element(
      "g",
      {},
      ...Array.from({ length: COMMON.bar }, (_, part) =>
        element("rect", {
          x: pixels(left + (part * length) / COMMON.bar),
          y: this.top(y),
          width: pixels(length - (part * length) / COMMON.bar),
          height: extent(height),
          fill: this.color(-2 - Math.round(from + ((part + 0.5) / COMMON.bar) * (to - from))),
        }),
      ),
    );
  }

  /** @param {number} place @returns {string} */
  color(place) {
    if (place === -1) return "none";
    whole(place, -1 - this.scale.length, this.palette.length - 1);
    return place < 0 ? this.scale[-2 - place] : this.palette[place];
  }

  /** @param {Outline} path */
  written(path) {
    for (const [, places] of path) this.places += places.length;
    need(this.places <= MOST_PLACES);
    return path.map(([letter, places]) => letter + places.map(pixels).join(" ")).join("");
  }

  /** @param {number} x */
  left(x) {
    return pixels(this.x + whole(x));
  }

  /** @param {number} y */
  top(y) {
    return pixels(this.y + whole(y));
  }
}

/** Return the painter of a level's picture. @param {PictureData} picture */
export function painterOf({ palette, scale = [] }) {
  list(palette, 100000).forEach(color);
  return new Painter(palette, list(scale, 20).length > 1 ? colorsOf(scale) : []);
}

/** Return the colours of a scale, evenly between its stops. @param {string[]} stops */
function colorsOf(stops) {
  const channels = stops.map((stop) => channelsOf(color(stop)));
  return Array.from({ length: COMMON.steps + 1 }, (_, step) => {
    const at = (step * (stops.length - 1)) / COMMON.steps;
    const [low, high] = [Math.floor(at), Math.ceil(at)].map((index) => channels[index]);
    return `rgb(${low.map((from, index) => Math.round(from + (at % 1) * (high[index] - from)))})`;
  });
}

/** Return red, green and blue of a colour. @param {string} given */
export function channelsOf(given) {
  return given
    .match(/[0-9a-f]{2}/g)
    .slice(0, 3)
    .map((part) => parseInt(part, 16));
}

/** @param {number} tenths */
function extent(tenths) {
  return pixels(whole(tenths, 0));
}

/** Return percent as a fraction; undefined for 100. @param {number} [percents] */
function share(percents = 100) {
  return whole(percents, 0, 100) === 100 ? undefined : percents / 100;
}

/**
 * Return the commands of a path, with places in tenths of a pixel.
 *
 * @param {string} commands
 * @param {number} x
 * @param {number} y
 * @returns {Outline}
 */
function outline(commands, x, y) {
  need(/^(?:[mlczs][-0-9 ]*)+$/.test(commands));
  const path = [];
  let last = [x, y];
  for (const [, letter, numbers] of commands.matchAll(/([mlczs])([-0-9 ]*)/g)) {
    const steps = (numbers.match(/-?[0-9]+/g) ?? []).map(Number);
    if (letter === "s") {
      path.push(...smooth(points(steps, last)));
      continue;
    }
    need(steps.length === PLACES[letter]);
    const places = steps.map((step, index) => whole(last[index % 2] + step));
    if (places.length > 0) last = places.slice(-2);
    path.push([letter.toUpperCase(), places]);
  }
  need(path[0][0] === "M");
  return path;
}

/**
 * Return points from steps that are relative to the previous point.
 *
 * @param {number[]} steps
 * @param {number[]} start
 * @returns {[number, number][]}
 */
function points(steps, [x, y]) {
  need(steps.length >= 6 && steps.length % 2 === 0);
  const all = [];
  for (let at = 0; at < steps.length; at += 2) {
    x = whole(x + steps[at]);
    y = whole(y + steps[at + 1]);
    all.push([x, y]);
  }
  return all;
}

/**
 * Return the closed smooth curve through points (a Catmull-Rom spline).
 *
 * @param {[number, number][]} all
 * @returns {any[]}
 */
function smooth(all) {
  const at = (index) => all[(index + all.length) % all.length];
  const curves = all.map(([x, y], index) => {
    const [before, next, after] = [at(index - 1), at(index + 1), at(index + 2)];
    return [
      "C",
      [
        x + (next[0] - before[0]) / 6,
        y + (next[1] - before[1]) / 6,
        next[0] - (after[0] - x) / 6,
        next[1] - (after[1] - y) / 6,
        ...next,
      ],
    ];
  });
  return [["M", all[0]], ...curves, ["Z", []]];
}
