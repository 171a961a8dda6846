// The view: which part of the picture is seen, and how large.

import { COMMON } from "./common.js";

const LARGEST_CELL = 128; // In pixels, while the whole picture is seen.
const LEAST_CELL = 20; // In pixels: of larger levels a part is seen at first,
const CELL_OF_PART = 32; // with cells of this size.
const MOST_ZOOM = 12;
export const ZOOM_STEP = 1.4;
const MAP_SIDE = 120; // The longer side of the map, in pixels.

/** The stage, in which a picture is zoomed and scrolled, and a map that shows which part. */
export class View {
  constructor(stage, map) {
    this.stage = stage;
    this.map = map;
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.room = null; // That of the stage; null after it may have changed.
    new ResizeObserver(() => {
      this.room = null;
      if (this.svg) this.zoomTo(this.zoom);
    }).observe(stage);
    stage.addEventListener("scroll", () => this.drawMap());
    const seek = ({ buttons, clientX, clientY }) => {
      if (buttons === 0) return;
      const { left, top, width } = map.getBoundingClientRect();
      const scale = this.svg.getBoundingClientRect().width / width;
      stage.scrollTo(
        scale * (clientX - left) - stage.clientWidth / 2,
        scale * (clientY - top) - stage.clientHeight / 2,
      );
      this.drawMap();
    };
    map.addEventListener("pointerdown", seek);
    map.addEventListener("pointermove", seek);
  }

  /**
   * Show a picture: the whole, or the part around the robot if its cells were too small. The map
   * marks the exits, whose cells have these corners.
   */
  show(svg, exits) {
    this.svg = svg;
    this.exits = exits;
    this.robot = svg.querySelector("#robot");
    this.stage.replaceChildren(svg);
    const { width, height } = svg.viewBox.baseVal;
    this.size = [width, height];
    // Of the picture with its legend, so that nothing around it moves.
    const ratio = (width / height).toFixed(3);
    if (ratio !== this.ratio) this.room = null;
    this.ratio = ratio;
    this.stage.parentElement.style.setProperty("--ratio", ratio);
    this.map.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.map.style.width = `${(MAP_SIDE * width) / Math.max(width, height)}px`;
    this.isMapDrawn = false;
    const fitting = (COMMON.cell * this.fittingWidth()) / width;
    this.zoomTo(fitting < LEAST_CELL ? CELL_OF_PART / fitting : 1);
  }

  /** Show the picture in its size, which may have changed. If a part is seen, cells keep theirs. */
  measure() {
    const { width, height } = this.svg.viewBox.baseVal;
    const scale = this.wide / this.size[0];
    this.size = [width, height];
    this.map.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.zoomTo(this.zoom === 1 ? 1 : (scale * width) / this.fittingWidth());
  }

  /** Show the whole picture. */
  fit() {
    this.zoomTo(1);
  }

  /** Return the width at which the whole picture is seen. */
  fittingWidth() {
    const [wide, high] = (this.room ??= this.measuredRoom());
    const [width, height] = this.size;
    const fitting = Math.min(wide, (high * width) / height);
    return Math.max(1, Math.min(fitting, (LARGEST_CELL * width) / COMMON.cell));
  }

  /** Return the width and height that the stage has for the picture; it is laid out for that. */
  measuredRoom() {
    const { clientWidth, clientHeight } = this.stage;
    const padding = 2 * parseFloat(getComputedStyle(this.stage).paddingLeft);
    return [clientWidth - padding, clientHeight - padding];
  }

  /** Show the picture so many times larger than it fits; a point of the window, or the robot, stays. */
  zoomTo(zoom, point = null) {
    const { svg, stage } = this;
    const [width, height] = this.size;
    const before = point === null ? null : svg.getBoundingClientRect();
    this.zoom = Math.min(MOST_ZOOM, Math.max(1, zoom));
    this.wide = this.fittingWidth() * this.zoom; // In pixels.
    svg.style.width = `${this.wide}px`;
    svg.style.height = `${(this.wide * height) / width}px`;
    const isPart = this.zoom > 1;
    stage.classList.toggle("wide", isPart);
    this.map.toggleAttribute("hidden", !isPart);
    if (point === null) {
      this.follow(false);
    } else {
      const [x, y] = point;
      const after = svg.getBoundingClientRect();
      const scale = after.width / before.width;
      stage.scrollBy(after.left - x + scale * (x - before.left), after.top - y + scale * (y - before.top));
    }
    this.drawMap();
  }

  /** Zoom as a wheel turns, where the pointer is. @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    this.zoomTo(this.zoom * ZOOM_STEP ** (-event.deltaY / 100), [event.clientX, event.clientY]);
  }

  /** Zoom and scroll as two fingers do that were spread in one way, and now are in another. */
  pinch([x, y, distance], [toX, toY, apart]) {
    this.zoomTo((this.zoom * apart) / Math.max(1, distance), [x, y]);
    this.stage.scrollBy(x - toX, y - toY);
  }

  /** Scroll so that the robot is seen, with the cells around it. */
  follow(isGliding = true) {
    const { stage } = this;
    const frame = stage.getBoundingClientRect();
    const robot = this.robot.getBoundingClientRect();
    const margin = 1.5 * robot.width;
    const isSeen =
      robot.left > frame.left + margin &&
      robot.right < frame.right - margin &&
      robot.top > frame.top + margin &&
      robot.bottom < frame.bottom - margin;
    if (!isSeen) {
      stage.scrollTo({
        left: stage.scrollLeft + robot.left - frame.left - (frame.width - robot.width) / 2,
        top: stage.scrollTop + robot.top - frame.top - (frame.height - robot.height) / 2,
        behavior: isGliding && !this.calm.matches ? "smooth" : "auto",
      });
    }
    this.drawMap();
  }

  /** Show on the map where the robot is, and which part of the picture is seen. */
  drawMap() {
    if (this.zoom === 1) return;
    if (!this.isMapDrawn) this.drawGround();
    const [, , dot, frame] = this.map.children;
    const [width, height] = this.size;
    const half = COMMON.cell / 2;
    const { left, top, width: wide } = this.svg.getBoundingClientRect();
    const scale = width / wide;
    const seen = this.stage.getBoundingClientRect();
    setAttributes(frame, {
      x: Math.max(0, scale * (seen.left - left)),
      y: Math.max(0, scale * (seen.top - top)),
      width: Math.min(width, scale * seen.width),
      height: Math.min(height, scale * seen.height),
    });
    const { e, f } = this.robot.transform.baseVal[0]?.matrix ?? { e: 0, f: 0 };
    setAttributes(dot, { cx: e + half, cy: f + half, r: this.signSize });
    // The map is in a corner in which the robot is not.
    const isBelow = [e / scale + left - seen.left > seen.width / 2, f / scale + top - seen.top > seen.height / 2];
    this.map.classList.toggle("left", isBelow.every(Boolean));
  }

  /** Draw the map itself: the level, and its exits. */
  drawGround() {
    this.isMapDrawn = true;
    const [image, marks] = this.map.children;
    const [width, height] = this.size;
    const half = COMMON.cell / 2;
    const size = this.signSize;
    setAttributes(image, { width, height, href: this.still() });
    setAttributes(marks, {
      d: this.exits
        .map(([x, y]) => `M${x + half} ${y + half - size}l${size} ${size}l${-size} ${size}l${-size} ${-size}z`)
        .join(""),
    });
  }

  /** The size of signs on the map, in units of the picture. */
  get signSize() {
    return (4 * Math.max(...this.size)) / MAP_SIDE;
  }

  /** Return the level without what moves and without answers, as an image of its own. */
  still() {
    const copy = this.svg.cloneNode(false);
    copy.removeAttribute("style");
    copy.append(this.svg.querySelector("#ground").cloneNode(true));
    for (const answer of copy.querySelectorAll("#heat, #beside, #places")) answer.remove();
    return `data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
  }
}

function setAttributes(shape, attributes) {
  for (const [name, value] of Object.entries(attributes)) shape.setAttribute(name, value);
}

/** Return the middle of two fingers, and how far they are apart. @param {Map<number, number[]>} fingers */
export function spread(fingers) {
  const [[ax, ay], [bx, by]] = fingers.values();
  return [(ax + bx) / 2, (ay + by) / 2, Math.hypot(bx - ax, by - ay)];
}
