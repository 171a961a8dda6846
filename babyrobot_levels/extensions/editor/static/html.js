// Elements of the panels.

/**
 * Return an HTML element. Attributes that are undefined, null or false are left out; functions are
 * listeners, such as `onclick`.
 *
 * @param {string} name
 * @param {Record<string, any>} attributes
 * @param {(Node | string | null)[]} children
 * @returns {any}
 */
export function html(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== undefined && value !== null && value !== false) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/**
 * Return a button; what it shows may be a text or an element.
 *
 * @param {Node | string} shown
 * @param {Record<string, any>} [attributes]
 * @returns {HTMLButtonElement}
 */
export function button(shown, attributes) {
  return html("button", { type: "button", ...attributes }, shown);
}

/**
 * Return the parts of a message; what stands between backticks is code.
 *
 * @param {string} message
 * @returns {(string | HTMLElement)[]}
 */
export function prose(message) {
  return message.split("`").map((part, index) => (index % 2 === 1 ? html("code", {}, part) : part));
}

/** Return words for what one has at hand: one taps with a finger. */
export function tapped(words) {
  return matchMedia("(hover: none)").matches ? words.replaceAll("Click", "Tap").replaceAll("click", "tap") : words;
}

/** Show HTML in an element, in a shadow root: styles neither leave nor enter it. Returns the root. */
export function shadow(place, style, content) {
  const root = place.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style);
  root.adoptedStyleSheets = [sheet];
  root.innerHTML = content;
  return root;
}
