// The elements of a page.

/** Return the element with an id, which the page has. */
export function byId(id) {
  return document.getElementById(id);
}
