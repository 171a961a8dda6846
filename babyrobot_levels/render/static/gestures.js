// Gestures on the picture: swipes move the robot, pinches zoom, drags scroll.

import { swiped } from "./game.js";
import { spread } from "./view.js";

/**
 * Listen to the pointers over the stage of a view.
 *
 * A finger that swipes calls `swipe` with the number of a side, once until it is lifted; one that
 * taps, or a click, calls `tap` with the event. Two fingers zoom and scroll, and so do a mouse that
 * drags and a wheel with the control key.
 */
export function listenToGestures(view, swipe, tap) {
  const { stage } = view;
  const fingers = new Map();
  let start = null; // Where the swipe began; null after it has been taken.
  let pressed = [0, 0]; // Where a finger, or the mouse, went down last.

  stage.addEventListener("pointerdown", ({ pointerType, pointerId, button, clientX, clientY }) => {
    if (button !== 0) return;
    fingers.set(pointerId, [clientX, clientY]);
    pressed = [clientX, clientY];
    start = pointerType !== "mouse" && fingers.size === 1 ? [clientX, clientY] : null;
  });
  addEventListener("pointermove", ({ pointerType, pointerId, clientX, clientY }) => {
    const last = fingers.get(pointerId);
    if (last === undefined) return;
    if (fingers.size === 2) {
      const before = spread(fingers);
      fingers.set(pointerId, [clientX, clientY]);
      view.pinch(before, spread(fingers));
      return;
    }
    fingers.set(pointerId, [clientX, clientY]);
    if (pointerType === "mouse") {
      stage.scrollBy(last[0] - clientX, last[1] - clientY);
    } else if (start !== null) {
      const [dx, dy] = [clientX - start[0], clientY - start[1]];
      const side = swiped(dx, dy);
      if (side === 0) return;
      start = null;
      swipe(side);
    }
  });
  stage.addEventListener("click", (event) => {
    if (swiped(event.clientX - pressed[0], event.clientY - pressed[1]) === 0) tap(event);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    addEventListener(name, (/** @type {any} */ { pointerId }) => fingers.delete(pointerId));
  }
  stage.addEventListener("wheel", (event) => event.ctrlKey && view.wheel(event), { passive: false });
}
