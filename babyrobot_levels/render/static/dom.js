// Elements of pages.

/** Return the element with an id, which the page has. @param {string} id @returns {any} */
export function byId(id) {
  return document.getElementById(id);
}

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
 * Return the parts of a message; what stands between backticks is code.
 *
 * @param {string} message
 * @returns {(string | HTMLElement)[]}
 */
export function prose(message) {
  return message.split("`").map((part, index) => (index % 2 === 1 ? html("code", {}, part) : part));
}

/** Save a text as a file of the browser's downloads. */
export function saveFile(download, text, type = "text/plain") {
  const href = URL.createObjectURL(new Blob([text], { type }));
  html("a", { href, download }).click();
  URL.revokeObjectURL(href);
}

/** Copy a text; pages that are not from this machine have no clipboard, but an element that one has pressed. */
export async function copyText(text, pressed) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = html("textarea", { class: "unseen" });
    field.value = text;
    pressed.after(field);
    field.select();
    document.execCommand("copy");
    field.remove();
    pressed.focus();
  }
}

/** Show a text that is read out; the same once more is another text, or it would not be read again. */
export function readOut(place, text) {
  place.textContent = place.textContent === text ? `${text}\u00a0` : text;
}

/** Return what the browser keeps under a name; null for nothing, or without storage. */
export function recallText(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

/** Keep a text under a name; without storage, it is forgotten with the page. Returns whether it is kept. */
export function keepText(name, text) {
  try {
    localStorage.setItem(name, text);
    return true;
  } catch {
    return false;
  }
}

/** Return what is kept as JSON under a name; null for nothing, or without storage. */
export function recalled(name) {
  try {
    return JSON.parse(recallText(name));
  } catch {
    return null;
  }
}

/** Keep something as JSON under a name; returns whether it is kept. */
export function keepData(name, data) {
  return keepText(name, JSON.stringify(data));
}

/** Return three signs, of which some are full stars. @param {number} stars */
export function starSigns(stars) {
  return "\u2605".repeat(stars).padEnd(3, "\u2606");
}

/** Show how many of three stars were given. @param {HTMLElement} place @param {number} stars */
export function showStars(place, stars) {
  place.textContent = starSigns(stars);
  place.setAttribute("aria-label", `${stars} of 3 stars`);
}
