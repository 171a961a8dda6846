// Drawing: from where a pointer is pressed to where it is released is one gesture, and one message.

import { gestureOf, sendOrSelect, takenAt, thingsAt, toolAt } from "./tools.js";

const EDGE = 20; // How near to the edge of the stage, in pixels, a pointer scrolls the picture,
const SCROLLED = 6; // and how far in each frame.

/**
 * What a pointer draws. Mouse and pen are listened to here; touch and keys call the same methods.
 *
 * A gesture is a function from the spots so far to its message, which is shown while one draws and
 * sent at the end.
 */
export class Pointer {
  constructor(editor, stage, overlay) {
    this.editor = editor;
    this.stage = stage;
    this.overlay = overlay;
    this.spots = null;
    const { place } = stage;
    place.addEventListener("pointerdown", (event) => event.pointerType !== "touch" && this.down(event));
    place.addEventListener("pointermove", (event) => event.pointerType !== "touch" && this.move(event));
    place.addEventListener("pointerup", () => this.release());
    place.addEventListener("pointercancel", () => this.cancel());
    place.addEventListener("pointerleave", () => this.leave());
    // The middle button pans, and does not begin to scroll by itself.
    place.addEventListener("mousedown", (event) => event.button === 1 && event.preventDefault());
    place.addEventListener("contextmenu", (event) => event.preventDefault());
    place.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  get isDrawing() {
    return this.editor.mode === "edit" && this.editor.game;
  }

  down(event) {
    if (!this.isDrawing || this.spots !== null) return;
    const { target, button, altKey, shiftKey } = event;
    const handle = target.closest("[data-handle]");
    const spot = this.stage.spotAt(event);
    if (button === 1 || (button === 0 && handle === null && this.isEmpty(spot))) {
      this.pan(event);
      if (button === 0) this.editor.select(null);
    } else if (handle !== null) {
      this.press(spot, this.overlay.gestureOf(handle, button === 2));
    } else if (button === 0 && altKey) {
      this.pick(spot);
      return;
    } else if (button === 0 || button === 2) {
      this.pressTool(spot, { erases: button === 2, ...(shiftKey ? { rectangle: true } : {}) });
    }
    this.stage.place.setPointerCapture(event.pointerId);
  }

  move(event) {
    if (!this.isDrawing) return;
    const spots = (event.getCoalescedEvents?.() ?? []).map((each) => this.stage.spotAt(each));
    if (this.panned) this.panTo(event);
    else if (this.spots !== null) this.dragTo(event, spots);
    else this.hover(this.stage.spotAt(event), event);
  }

  /** Begin to draw at a spot with the tool at hand. */
  pressTool(spot, modifiers = {}) {
    this.press(spot, (spots) => gestureOf(this.editor, spots, modifiers));
  }

  /** Begin a gesture at a spot: `messageOf` returns the message for spots, or null. */
  press(spot, messageOf) {
    this.spots = [spot];
    this.messageOf = messageOf;
    this.overlay.preview(messageOf(this.spots));
  }

  /** Go on to a point of the window; near the edge of the stage, the picture scrolls meanwhile. */
  dragTo(event, spots = []) {
    if (this.spots === null) return;
    this.drag(...spots, this.stage.spotAt(event));
    cancelAnimationFrame(this.scrolling);
    const { place, view } = this.stage;
    const { left, top, right, bottom } = place.getBoundingClientRect();
    const ways = [
      [left, event.clientX, right],
      [top, event.clientY, bottom],
    ].map(([low, at, high]) => Number(at > high - EDGE) - Number(at < low + EDGE));
    if (view.zoom === 1 || ways.every((way) => way === 0)) return;
    place.scrollBy(...ways.map((way) => SCROLLED * way));
    this.scrolling = requestAnimationFrame(() => this.dragTo(event));
  }

  /** Go on to other spots. */
  drag(...spots) {
    this.spots?.push(...spots);
    if (this.spots) this.overlay.preview(this.messageOf(this.spots), this.spots.at(-1));
  }

  /** End the gesture: send it, or select what is there if there is nothing to send. */
  release() {
    this.endPan();
    if (this.spots === null) return;
    const { spots } = this;
    const message = this.messageOf(spots);
    this.spots = null;
    if (spots[0].cell !== null)
      this.editor.set("cursor", { cursor: { cell: spots.at(-1).cell ?? spots[0].cell, side: null } });
    if (message === null) this.overlay.preview(null);
    sendOrSelect(this.editor, spots, message);
  }

  /** Give the gesture up; nothing has changed. */
  cancel() {
    this.spots = null;
    this.endPan();
    this.overlay.preview(null);
  }

  /** Show what a click at a spot would do. */
  hover(spot, { shiftKey = false } = {}) {
    this.overlay.preview(spot.cell === null ? null : gestureOf(this.editor, [spot], { rectangle: shiftKey }));
    this.stage.place.classList.toggle("over-thing", spot.cell !== null && takenAt(this.editor, spot) !== null);
    if (String(spot.cell) !== String(this.editor.pointed)) this.editor.set("pointed", { pointed: spot.cell });
  }

  leave() {
    if (this.spots === null) this.overlay.preview(null);
    this.editor.set("pointed", { pointed: null });
  }

  /** Take the tool with which what is at a spot was drawn. */
  pick(spot) {
    const found = spot.cell === null ? null : toolAt(this.editor, spot);
    if (found !== null) this.editor.choose(found.tool, found.options);
  }

  /** Return whether there is nothing to select or draw at a spot, so that dragging moves the picture. */
  isEmpty(spot) {
    if (spot.cell === null) return true;
    return this.editor.tool === "select" && thingsAt(this.editor, spot).length === 0 && this.stage.view.zoom > 1;
  }

  pan({ clientX, clientY }) {
    this.panned = [clientX, clientY];
    this.stage.place.classList.add("panned");
  }

  endPan() {
    this.panned = null;
    this.stage.place.classList.remove("panned");
  }

  panTo({ clientX, clientY }) {
    this.stage.place.scrollBy(this.panned[0] - clientX, this.panned[1] - clientY);
    this.panned = [clientX, clientY];
  }

  wheel(event) {
    const { selection } = this.editor;
    if (event.ctrlKey) {
      this.stage.view.wheel(event);
    } else if (
      selection?.fields.pass > 0 &&
      this.isDrawing &&
      thingsAt(this.editor, this.stage.spotAt(event)).includes(selection)
    ) {
      event.preventDefault();
      const pass = Math.min(0.95, Math.max(0.05, selection.fields.pass - Math.sign(event.deltaY) * 0.05));
      this.editor.send({ do: "set", route: [...selection.route, "pass"], value: Number(pass.toFixed(2)) });
    }
  }
}
