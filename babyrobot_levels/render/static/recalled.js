// What the browser keeps as JSON.

import { keepText, recallText } from "./dom.js";

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
