// In place of `views.js` in pages without an agent, which have less to load.

import { byId } from "./dom.js";

/** The optimum is shown. */
export class Views {
  begin() {}
  stand() {
    byId("policy-name").textContent = "Optimal actions"; // While it learns, they are others.
  }
}
