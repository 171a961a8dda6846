// For what is held values and optimal actions are shown: as it is now, or as one chooses.

import { html } from "./dom.js";

const MOST = 16; // How many sets of held things are offered.

export class ShownSets {
  /** `place` is a fieldset; `look` shows a configuration until the state at hand is shown again. */
  constructor(place, look) {
    this.place = place;
    this.look = look;
    place.addEventListener("change", ({ target }) => this.choose(target.value));
  }

  /** Offer what can be held and on in a game. */
  begin(game) {
    this.game = game;
    this.all = game.things.situations(game.data.possible.length / game.cells);
    const names = [...this.all.keys()];
    const chips = names.slice(0, names.length > 1 ? MOST : 0).map((value) => {
      return html("label", {}, html("input", { type: "radio", name: "shown-set", value }), value);
    });
    if (names.length > MOST) chips.push(html("span", {}, `and ${names.length - MOST} more, when one comes to them`));
    this.told = html("p", {});
    if (chips.length > 0) chips.unshift(html("legend", {}, "Values and actions for"));
    this.place.replaceChildren(...chips, this.told);
  }

  /** Tell which configuration is shown. */
  stand(isSeen, configuration = this.game.configuration) {
    const { data, things } = this.game;
    this.words = things.words(configuration);
    for (const input of this.place.querySelectorAll("input")) input.checked = input.value === this.words;
    const states = things.met(configuration).map(([state]) => state);
    const nothing = `nothing ${states.join(" or ")}`;
    const hatched = this.game.marks("values", configuration).includes(data.picture.never ?? -2);
    const texts = [
      hatched && `Hatched: cannot occur with ${this.words === "Nothing" ? nothing : this.words}.`,
      things.of("mover").length > 0 && "Answers are for movers where the picture shows them.",
      data.robots !== undefined && `Answers are for ${data.robots[0].name}, with the others where they are.`,
    ];
    this.told.textContent = texts.filter(Boolean).join(" ");
    this.place.hidden = !isSeen || (this.all.size < 2 && this.told.textContent === "");
  }

  /** Show what is chosen, with everything else as it is now as far as possible. */
  choose(words) {
    const { data, cells, things, configuration: now } = this.game;
    const likeness = (at) => things.all.filter(({ values }) => values[at] === values[now]).length;
    let best = this.all.get(words);
    for (let at = 0; at < data.possible.length / cells; at++) {
      if (things.words(at) === words && likeness(at) > likeness(best)) best = at;
    }
    this.look(best);
    this.stand(true, best);
  }
}
