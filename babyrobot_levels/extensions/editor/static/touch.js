// Fingers on the picture: one draws, two scroll and zoom, a long press selects.
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
    const before = this.fingers.size === 2 ? this.pair() : null;
    this.fingers.set(pointerId, [clientX, clientY]);
    if (before !== null && this.pointer.editor.game) this.zoom(before, this.pair());
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
    if (this.pointer.isDrawing) this.pointer.selectAt(this.stage.spotAt(event));
  }

  zoom([from, apart], [to, farther]) {
    const { place, view } = this.stage;
    view.zoomTo((view.zoom * farther) / Math.max(1, apart), from);
    place.scrollBy(from[0] - to[0], from[1] - to[1]);
  }

  /** Return the middle of two fingers, and how far they are apart. @returns {[[number, number], number]} */
  pair() {
    const [[ax, ay], [bx, by]] = [...this.fingers.values()];
    return [[(ax + bx) / 2, (ay + by) / 2], Math.hypot(bx - ax, by - ay)];
  }
}
