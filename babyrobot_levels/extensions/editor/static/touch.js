// Fingers on the picture: one draws, two scroll and zoom, a long press selects.

import { spread } from "../../../render/static/view.js";
import { selectAt } from "./tools.js";

const LONG_PRESS = 500; // Milliseconds
const STILL = 10; // and pixels: a finger that stays within them presses.

/** What fingers do on the picture. */
export class Fingers {
  constructor(stage, pointer) {
    this.stage = stage;
    this.pointer = pointer;
    this.fingers = new Map();
    const { place } = stage;
    const listen = (name, action) =>
      place.addEventListener(name, (event) => event.pointerType === "touch" && action(event));
    listen("pointerdown", (event) => this.down(event));
    listen("pointermove", (event) => this.move(event));
    listen("pointerup", (event) => this.up(event));
    listen("pointercancel", (event) => this.up(event));
    // Else the browser makes clicks, menus and flings of the same touches, and drops taps meanwhile.
    place.addEventListener("touchstart", (event) => event.cancelable && event.preventDefault(), { passive: false });
  }

  down(event) {
    this.stage.place.focus({ preventScroll: true });
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.fingers.size > 1) {
      this.leave();
      return;
    }
    this.first = [event.clientX, event.clientY];
    this.isDrawing = true;
    this.pointer.down(event);
    const isHandle = event.target.closest("[data-handle]") !== null;
    if (!isHandle) this.timer = setTimeout(() => this.inspect(event), LONG_PRESS);
  }

  move(event) {
    const { pointerId, clientX, clientY } = event;
    if (!this.fingers.has(pointerId)) return;
    const before = this.fingers.size === 2 ? spread(this.fingers) : null;
    this.fingers.set(pointerId, [clientX, clientY]);
    if (before !== null && this.pointer.editor.game) this.stage.view.pinch(before, spread(this.fingers));
    if (Math.hypot(clientX - this.first[0], clientY - this.first[1]) > STILL) clearTimeout(this.timer);
    if (this.isDrawing) this.pointer.move(event);
  }

  up({ pointerId }) {
    clearTimeout(this.timer);
    this.fingers.delete(pointerId);
  }

  /** Draw nothing more until another finger begins alone. */
  leave() {
    clearTimeout(this.timer);
    this.isDrawing = false;
    this.pointer.cancel();
  }

  /** Select what is under the finger instead of drawing. */
  inspect(event) {
    this.leave();
    if (this.pointer.isDrawing) selectAt(this.pointer.editor, this.stage.spotAt(event));
  }
}
