// An agent beside the optimum: which of them is shown over the cells, or what the agent costs.

import { byId } from "./dom.js";

const NAMES = {
  optimum: ["Optimal actions", "The optimal expected returns without a limit"],
  agent: ["Agent's actions", "The agent's expected returns without a limit"],
  costs: ["Actions", "How much less the agent's actions are worth than optimal ones"],
};
const LIGHT = "Dark arrows: the agent's actions where they are not optimal. Light arrows: optimal ones.";

/** The choice of what is shown, and the table of the states in which the agent differs. */
export class Views {
  /** @param {() => void} show Shows what is chosen. @param {(cells: number[]) => void} outline */
  constructor(show, outline) {
    this.place = byId("views");
    this.table = byId("differences");
    this.place.addEventListener("change", ({ target }) => {
      this.game.view = target.value;
      show();
    });
    for (const row of this.table?.querySelectorAll("[data-cell]") ?? []) {
      row.addEventListener("pointerenter", () => outline([Number(row.dataset.cell)]));
      row.addEventListener("pointerleave", () => outline([]));
    }
  }

  /** @param {Game} game */
  begin(game) {
    this.game = game;
    if (this.table !== null) this.table.hidden = game.data.agent === undefined;
  }

  /** Show which view is chosen. */
  stand() {
    const { data, isTurning, view } = this.game;
    const [actions, values] = NAMES[isTurning ? "optimum" : view];
    this.place.hidden = isTurning || data.agent?.costs === undefined;
    for (const input of this.place.querySelectorAll("input")) input.checked = input.value === view;
    byId("policy-name").textContent = actions;
    byId("show-values").title = values;
    const isCost = !isTurning && view === "costs";
    byId("view-told").textContent = isCost ? LIGHT : "";
    byId("value-scale").classList.toggle("hidden", isCost);
    byId("cost-scale").classList.toggle("hidden", !isCost);
  }
}
