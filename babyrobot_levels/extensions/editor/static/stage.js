// The stage: the picture of the level, which keeps its zoom while the level changes.

import { COMMON } from "../../../render/static/common.js";
import { element } from "../../../render/static/paint.js";
import { levelPicture, Picture, sprites } from "../../../render/static/picture.js";
import { gameOf } from "../../../render/static/team.js";
import { View } from "../../../render/static/view.js";
import { FINGER_REACH, REACH, spotAt } from "./spots.js";

const MAP_PAUSE = 300; // Milliseconds without a change, after which the map is drawn anew.

/** A view that follows the robot only while one plays, and keeps its part of the picture. */
class StageView extends View {
  constructor(editor, stage, map) {
    super(stage, map);
    this.editor = editor;
  }

  show(svg, exits) {
    const { stage, size, svg: before, zoom, wide } = this;
    const place = zoom > 1 ? [stage.scrollLeft, stage.scrollTop] : null;
    super.show(svg, exits);
    if (!before) return;
    // The cells keep their size on the screen if a part is seen, and else the whole is.
    this.zoomTo(zoom === 1 ? 1 : ((wide / size[0]) * this.size[0]) / this.fittingWidth());
    if (place !== null) stage.scrollTo(...place);
  }

  zoomTo(...args) {
    super.zoomTo(...args);
    if (this.svg === this.editor.picture?.svg) this.editor.tell("zoom");
  }

  /** Zoom by a factor; what is in the middle stays there. */
  zoomBy(factor) {
    const { left, top, width, height } = this.stage.getBoundingClientRect();
    this.zoomTo(this.zoom * factor, [left + width / 2, top + height / 2]);
  }

  /** Draw the map when one pauses: of a large level, that takes as long as the picture. */
  drawGround() {
    clearTimeout(this.drawing);
    this.drawing = setTimeout(() => super.drawGround(), MAP_PAUSE);
  }

  follow(isGliding) {
    if (this.editor.mode === "play") super.follow(isGliding);
    else this.drawMap();
  }
}

/** The picture of the state at hand: `editor.game` and `editor.picture`, drawn anew for each. */
export class Stage {
  constructor(editor, place, map, notice) {
    this.editor = editor;
    this.place = place;
    this.notice = notice;
    this.view = new StageView(editor, place, map);
    editor.stage = this;
    editor.on("state", () => this.show());
  }

  show() {
    const { level, is_valid, too_large } = this.editor.state;
    this.place.classList.toggle("dimmed", !is_valid);
    this.notice.textContent =
      too_large ?? (level === null ? "There is no picture: the text is not a valid level." : "");
    if (level === null) {
      this.place.replaceChildren();
      Object.assign(this.editor, { game: null, picture: null });
      return;
    }
    const svg = levelPicture(level, this.symbols(level.robot));
    const game = gameOf(level);
    this.layers = element("g", { class: "layers" });
    svg.append(this.layers);
    this.editor.game = game;
    this.editor.picture = new Picture(game, svg, this.view);
    this.editor.picture.stand();
  }

  /** Return the robot's symbols: those of the last picture if its colours are the same. */
  symbols(robot) {
    const colors = robot.join();
    if (this.robot?.colors !== colors) this.robot = { colors, symbols: sprites(robot) };
    return this.robot.symbols;
  }

  /** Return the group of a name above the picture, empty in every new picture. */
  layer(name) {
    return this.layers.querySelector(`:scope > .${name}`) ?? this.layers.appendChild(element("g", { class: name }));
  }

  /** Return how many units of the picture a pixel of the window has. */
  get unit() {
    return this.view.size[0] / this.view.wide;
  }

  /** Return a point of the window as a point in cells. @param {PointerEvent} event @returns {any} */
  pointAt({ clientX, clientY }) {
    const { left, top } = this.view.svg.getBoundingClientRect();
    const { margin } = this.editor.game.data;
    return [clientX - left, clientY - top].map((pixels) => (this.unit * pixels - margin) / COMMON.cell);
  }

  /** Return the spot at a point of the window. */
  spotAt(event) {
    const { width, height } = this.editor.game.data;
    return spotAt(this.pointAt(event), [width, height], event.pointerType === "touch" ? FINGER_REACH : REACH);
  }
}
