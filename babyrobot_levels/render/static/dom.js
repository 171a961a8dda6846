// The elements of a page.

/**
 * Return the element with an id, which the page has.
 *
 * @param {string} id
 * @returns {any}
 */
export function byId(id) {
  return document.getElementById(id);
}

/** Return what the browser keeps under a name; null for nothing, or without storage. */
export function recallText(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

/** Keep a text under a name; without storage, it is forgotten with the page. */
export function keepText(name, text) {
  try {
    localStorage.setItem(name, text);
  } catch {
    // As above.
  }
}

/**
 * Return three signs, of which some are full stars.
 *
 * @param {number} stars
 */
export function starSigns(stars) {
  return "\u2605".repeat(stars).padEnd(3, "\u2606");
}

/**
 * Show how many of three stars were given.
 *
 * @param {HTMLElement} place
 * @param {number} stars
 */
export function showStars(place, stars) {
  place.textContent = starSigns(stars);
  place.setAttribute("aria-label", `${stars} of 3 stars`);
}
