// Drawing: from where a pointer is pressed to where it is released is one gesture, and one message.

/**
 * What a pointer draws. Mouse and pen are listened to here; touch and keys call the same methods.
 *
 * A gesture is a function from the spots so far to its message, which is shown while one draws and
 * sent at the end.
 */
class Pointer {
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
    place.addEventListener("pointerleave", () => this.spots ?? overlay.preview(null));
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
    else if (this.spots !== null) this.drag(...spots, this.stage.spotAt(event));
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

  /** Go on to other spots. */
  drag(...spots) {
    this.spots?.push(...spots);
    if (this.spots) this.overlay.preview(this.messageOf(this.spots), this.spots.at(-1));
  }

  /** End the gesture: send it, or select what is there if there is nothing to send. */
  release() {
    this.panned = null;
    if (this.spots === null) return;
    const { spots } = this;
    const message = this.messageOf(spots);
    this.spots = null;
    if (spots[0].cell !== null) this.editor.set("cursor", { cursor: { cell: spots.at(-1).cell ?? spots[0].cell, side: null } });
    if (message === null) this.overlay.preview(null);
    sendOrSelect(this.editor, spots, message);
  }

  /** Give the gesture up; nothing has changed. */
  cancel() {
    this.spots = this.panned = null;
    this.overlay.preview(null);
  }

  /** Show what a click at a spot would do. */
  hover(spot, { shiftKey = false } = {}) {
    this.overlay.preview(spot.cell === null ? null : gestureOf(this.editor, [spot], { rectangle: shiftKey }));
    const thing = this.editor.tool === "select" && spot.cell !== null ? pickedAt(this.editor, spot) : null;
    this.stage.place.classList.toggle("over-thing", thing !== null);
  }

  /** Select what is at a spot. */
  selectAt(spot) {
    selectAt(this.editor, spot);
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
  }

  panTo({ clientX, clientY }) {
    this.stage.place.scrollBy(this.panned[0] - clientX, this.panned[1] - clientY);
    this.panned = [clientX, clientY];
  }

  wheel(event) {
    const { selection } = this.editor;
    if (event.ctrlKey) {
      event.preventDefault();
      const { view } = this.stage;
      view.zoomTo(view.zoom * ZOOM_STEP ** (-event.deltaY / 100), [event.clientX, event.clientY]);
    } else if (selection?.fields.pass > 0 && this.isDrawing && thingsAt(this.editor, this.stage.spotAt(event)).includes(selection)) {
      event.preventDefault();
      const pass = Math.min(0.95, Math.max(0.05, selection.fields.pass - Math.sign(event.deltaY) * 0.05));
      this.editor.send({ do: "set", route: [...selection.route, "pass"], value: Number(pass.toFixed(2)) });
    }
  }
}
