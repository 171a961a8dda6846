// The divider between board and panels: it makes the panels wider, and keeps how wide they are.

const LEAST = 272; // Pixels.
const STEP = 32;
const COOKIE = "babyrobot-panels"; // Storage is by port, which is another one each time; a cookie is not.

/** Something to drag, or to move with arrow keys, at the left side of the panels. */
export class Divider {
  constructor(root, panels) {
    this.root = root;
    this.panels = panels;
    this.element = panels.querySelector(".divide");
    this.element.setAttribute("aria-valuemin", LEAST);
    this.element.onkeydown = (event) => this.press(event);
    this.element.onpointerdown = ({ pointerId }) => this.element.setPointerCapture(pointerId);
    this.element.onpointermove = (event) => this.drag(event);
    this.element.ondblclick = () => this.set(null);
    const [, kept = ""] = document.cookie.match(`${COOKIE}=([0-9]+px)`) ?? [];
    root.style.setProperty("--panels", kept);
    const tell = () => this.element.setAttribute("aria-valuenow", Math.round(panels.clientWidth));
    new ResizeObserver(tell).observe(panels);
  }

  /** Make the panels so many pixels wide; null for the usual width. */
  set(width) {
    const kept = width === null ? "" : `${Math.round(Math.max(LEAST, width))}px`;
    this.root.style.setProperty("--panels", kept);
    // biome-ignore lint/suspicious/noDocumentCookie: not every browser has cookieStore.
    document.cookie = `${COOKIE}=${kept}; max-age=31536000; path=/; samesite=strict`;
  }

  drag({ pointerId, clientX }) {
    if (this.element.hasPointerCapture(pointerId)) this.set(this.panels.getBoundingClientRect().right - clientX);
  }

  press(event) {
    const way = { ArrowLeft: 1, ArrowRight: -1 }[event.key];
    if (way === undefined) return;
    event.preventDefault();
    this.set(this.panels.clientWidth + way * STEP);
  }
}
