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
