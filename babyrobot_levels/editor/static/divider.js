// The divider between board and panels: it makes the panels wider, and keeps how wide they are.

import { html } from "./html.js";

const LEAST = 272; // Pixels.
const STEP = 32;
const COOKIE = "babyrobot-panels"; // Storage is by port, which is another one each time; a cookie is not.

/** Something to drag, or to move with arrow keys, at the left side of the panels. */
export class Divider {
  constructor(root, panels) {
    this.root = root;
    this.panels = panels;
    this.element = html("div", {
      class: "divide",
      role: "separator",
      tabindex: "0",
      title: "Drag to make the panels wider; double-click for the usual width",
      "aria-label": "Width of the panels",
      "aria-orientation": "vertical",
      "aria-valuemin": LEAST,
      onkeydown: (event) => this.press(event),
      onpointerdown: ({ pointerId }) => this.element.setPointerCapture(pointerId),
      onpointermove: (event) =>
        this.element.hasPointerCapture(event.pointerId) &&
        this.set(this.panels.getBoundingClientRect().right - event.clientX),
      ondblclick: () => this.set(null),
    });
    panels.append(this.element);
    const kept = document.cookie.match(`${COOKIE}=([0-9]+)`);
    if (kept !== null) this.root.style.setProperty("--panels", `${kept[1]}px`);
    new ResizeObserver(() => this.tell()).observe(panels);
  }

  /** Make the panels so many pixels wide; null for the usual width. */
  set(width) {
    const pixels = width === null ? null : Math.round(Math.max(LEAST, Math.min(this.most, width)));
    if (pixels === null) this.root.style.removeProperty("--panels");
    else this.root.style.setProperty("--panels", `${pixels}px`);
    // biome-ignore lint/suspicious/noDocumentCookie: not every browser has cookieStore.
    document.cookie = `${COOKIE}=${pixels ?? ""}; max-age=${pixels === null ? 0 : 31536000}; path=/; samesite=strict`;
  }

  get most() {
    return Math.max(LEAST, 0.65 * this.root.clientWidth);
  }

  tell() {
    this.element.setAttribute("aria-valuenow", Math.round(this.panels.clientWidth));
    this.element.setAttribute("aria-valuemax", Math.round(this.most));
  }

  press(event) {
    const way = { ArrowLeft: 1, ArrowRight: -1 }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    this.set(this.panels.clientWidth + way * STEP);
  }
}
