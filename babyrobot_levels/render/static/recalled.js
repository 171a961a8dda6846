// What the browser keeps as JSON.

import { recallText } from "./dom.js";

/** Return what is kept as JSON under a name; null for nothing, or without storage. */
export function recalled(name) {
  try {
    return JSON.parse(recallText(name));
  } catch {
    return null;
  }
}
