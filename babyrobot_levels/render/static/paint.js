// Paints packed shapes as SVG: five kinds, each with its own attributes.
const FONT = "Helvetica, Arial, 'Liberation Sans', sans-serif";
const ANCHORS = ["start", "middle", "end"];
const PLACES = { m: 2, l: 2, c: 6, z: 0 };

/** Return an SVG element; attributes that are undefined are left out. */
function element(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** Return tenths of a pixel as pixels. */
function pixels(tenths) {
  return Math.round(tenths * 10) / 100;
}

/** Paints the layers of one picture. */
class Painter {
  constructor(palette) {
    this.palette = palette;
    this.shapes = 0;
    this.places = 0;
  }

  /** Return the shapes of a layer as elements. */
  layer(groups) {
    return list(groups).flatMap((group) => {
      const [x, y, shapes] = list(group, 3, 3);
      this.x = whole(x);
      this.y = whole(y);
      this.outline = null;
      this.shapes += list(shapes).length;
      need(this.shapes <= MOST_SHAPES);
      return shapes.map((shape) => this.paint(list(shape, 9, 3)));
    });
  }

  paint([kind, fill, ...more]) {
    const kinds = [this.rect, this.ellipse, this.path, this.text, this.again];
    return kinds[whole(kind, 0, kinds.length - 1)].call(this, this.color(fill), ...more);
  }

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
    return element("text", {
      x: this.left(x),
      y: this.top(y),
      "font-size": extent(size),
      "font-weight": whole(isBold, 0, 1) ? "bold" : undefined,
      "text-anchor": ANCHORS[whole(anchor, 0, 2)],
      fill,
      opacity: share(opacity),
    }, text(words));
  }

  again(fill, scale, x, y, opacity) {
    need(this.outline !== null);
    const middle = [this.x + whole(x), this.y + whole(y)];
    const times = whole(scale, 0, 1000000) / 1000;
    const scaled = this.outline.map(([letter, places]) => [
      letter,
      places.map((place, index) => middle[index % 2] + times * (place - middle[index % 2])),
    ]);
    return element("path", { d: this.written(scaled), fill, opacity: share(opacity) });
  }

  color(place) {
    return place === -1 ? "none" : this.palette[whole(place, 0, this.palette.length - 1)];
  }

  written(path) {
    for (const [, places] of path) this.places += places.length;
    need(this.places <= MOST_PLACES);
    return path.map(([letter, places]) => letter + places.map(pixels).join(" ")).join("");
  }

  left(x) {
    return pixels(this.x + whole(x));
  }

  top(y) {
    return pixels(this.y + whole(y));
  }
}

function extent(tenths) {
  return pixels(whole(tenths, 0));
}

/** Return percent as a fraction; undefined for 100. */
function share(percents = 100) {
  return whole(percents, 0, 100) === 100 ? undefined : percents / 100;
}

/** Return the commands of a path, with places in tenths of a pixel. */
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

/** Return points from steps that are relative to the previous point. */
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

/** Return the closed smooth curve through points (a Catmull-Rom spline). */
function smooth(all) {
  const at = (index) => all[(index + all.length) % all.length];
  const curves = all.map(([x, y], index) => {
    const [before, next, after] = [at(index - 1), at(index + 1), at(index + 2)];
    return ["C", [
      x + (next[0] - before[0]) / 6,
      y + (next[1] - before[1]) / 6,
      next[0] - (after[0] - x) / 6,
      next[1] - (after[1] - y) / 6,
      ...next,
    ]];
  });
  return [["M", all[0]], ...curves, ["Z", []]];
}
