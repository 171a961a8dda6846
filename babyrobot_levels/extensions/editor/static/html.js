// Elements of the panels.

import { html } from "../../../render/static/dom.js";

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
 * Return a function that finds the elements of a place by their selectors.
 *
 * @param {ParentNode} place
 * @returns {(selector: string) => any}
 */
export function finder(place) {
  return (selector) => place.querySelector(selector);
}

/** Return pairs of a name and a value as the items of a list. */
export function factRows(facts) {
  return facts.map(([name, value]) => html("div", {}, html("dt", {}, name), html("dd", {}, value)));
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
