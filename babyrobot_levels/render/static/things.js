// Things: items, doors, switches, boxes, movers and exits, whose values make up a configuration.

import { list } from "./checks.js";
import { COMMON } from "./common.js";
import { element } from "./paint.js";

/** Return a list in words. @param {string[]} words */
export function listed(words) {
  return words.join(", ").replace(/, ([^,]*)$/, " and $1");
}

/** The things of one level, without a picture. */
export class Things {
  /** @param {Pick<LevelData, "things" | "exits">} data */
  constructor({ things = [], exits }) {
    this.all = things;
    this.exits = exits;
  }

  /** Return the things of a kind. @param {string} kind @returns {Thing[]} */
  of(kind) {
    return this.all.filter((thing) => thing.kind === kind);
  }

  /**
   * Return the things that are held, and those that are on: each state that one can have, with them.
   *
   * @param {number} configuration
   * @returns {[string, Thing[]][]}
   */
  met(configuration) {
    const states = new Set(Object.values(COMMON.needed));
    return [...states].flatMap((state) => {
      const things = this.all.filter(({ kind }) => COMMON.needed[kind] === state);
      return things.length === 0 ? [] : [[state, things.filter((thing) => isLast(thing, configuration))]];
    });
  }

  /** Return what is held and on in a configuration, in words. @param {number} configuration */
  words(configuration) {
    const met = this.met(configuration).flatMap(([state, found]) =>
      found.map(({ name }) => (state === "held" ? name : `${name} ${state}`)),
    );
    return met.join(", ") || "Nothing";
  }

  /**
   * Return what can be held and on, in words, each with its first configuration; fewer come first.
   *
   * @param {number} configurations
   * @returns {Map<string, number>}
   */
  situations(configurations) {
    /** @type {Map<string, number>} */
    const found = new Map();
    for (let at = configurations - 1; at >= 0; at--) found.set(this.words(at), at);
    const count = (words) => words.split(",").length;
    return new Map([...found].sort((one, other) => count(one[0]) - count(other[0]) || one[1] - other[1]));
  }

  /** Return the cells that end an episode as exits. @param {number} configuration @returns {number[]} */
  exitsOf(configuration) {
    const [exit] = this.of("exit");
    return exit === undefined ? this.exits : exit.exits[exit.values[configuration]];
  }

  /**
   * Return whether all targets are covered, which ends episodes of levels without an exit.
   *
   * @param {number} configuration
   */
  isSolved(configuration) {
    const targets = this.of("target");
    const hasExits = this.exits.length > 0 || this.of("exit").length > 0;
    return !hasExits && targets.length > 0 && targets.every((target) => isLast(target, configuration));
  }

  /** Return the cells in which things lie that can be held, or on. @param {number} configuration @returns {number[]} */
  lying(configuration) {
    const needed = this.all.filter(({ kind }) => kind in COMMON.needed);
    return needed.flatMap(({ cells, values }) => cells[values[configuration]]);
  }

  /** Return the things in a cell. @param {number} configuration @param {number} cell */
  at(configuration, cell) {
    return this.all.filter(({ cells, values }) => cells?.[values[configuration]].includes(cell));
  }

  /** Describe what the exits need while they are locked. @param {number} configuration */
  needs(configuration) {
    const [exit] = this.of("exit");
    if (exit === undefined || this.exitsOf(configuration).length > 0) return "";
    return ` It needs ${listed(exit.needs)}.`;
  }

  /**
   * Return the closed door that refuses a move; undefined for none.
   *
   * @param {number} configuration
   * @param {number} cell
   * @param {number} move
   */
  doorAt(configuration, cell, move) {
    return this.of("door").find(
      (door) =>
        isLast(door, configuration) &&
        door.sides.some((place, at) => at % 2 === 0 && place === cell && door.sides[at + 1] === move),
    );
  }

  /**
   * Describe what changed from one configuration to another.
   *
   * @param {number} before
   * @param {number} after
   * @returns {string[]}
   */
  changes(before, after) {
    const words = {
      held: ({ name }) => `Took the ${name}`,
      on: (thing) => `The ${thing.name} is ${isLast(thing, after) ? "on" : "off"}`,
      covered: (thing) => `The ${thing.name} is ${isLast(thing, after) ? "covered" : "not covered"}`,
      door: (thing) => `The ${thing.name} ${isLast(thing, after) ? "closes" : "opens"}`,
      exit: () => `The exit is ${this.exitsOf(after).length > 0 ? "open" : "closed"}`,
    };
    const changed = this.all.filter(({ values }) => values[before] !== values[after]);
    const pushed = changed.some(({ kind }) => kind === "box") ? ["A box is pushed"] : [];
    const others = Object.entries(words).flatMap(([what, told]) =>
      changed.filter(({ kind }) => (COMMON.needed[kind] ?? kind) === what).map(told),
    );
    return [...pushed, ...others];
  }
}

/**
 * Return whether a thing has its last value: it is held, or on; a door is closed.
 *
 * @param {Thing} thing
 * @param {number} configuration
 */
function isLast({ values, looks }, configuration) {
  return values[configuration] === looks.length - 1;
}

/** Return whether a thing moves from cell to cell: a mover, or a robot beside the first one. @param {Thing} thing */
function moves({ kind }) {
  return kind === "mover" || kind === "robot";
}

/** The pictures of things in a level's picture. */
export class ThingsLayer {
  /** @param {Game} game @param {SVGElement} svg */
  constructor(game, svg) {
    this.game = game;
    this.movers = game.things.all.filter(moves);
    this.others = game.things.all.filter((thing) => !moves(thing));
    this.groups = [...svg.querySelectorAll("#things > g")];
    this.moving = [...svg.querySelectorAll("#movers > g")];
    this.shown = this.others.map(() => null);
  }

  /** Show the things of a state. @param {number} state */
  stand(state) {
    const configuration = this.game.configurationOf(state);
    this.others.forEach(({ values, looks }, index) => {
      const value = values[configuration];
      if (this.shown[index] === value) return;
      this.shown[index] = value;
      this.groups[index].replaceChildren(...looks[value].map(lookElement));
    });
    this.movers.forEach(({ values, looks }, index) => {
      const [look] = looks[values[configuration]];
      this.moving[index].firstElementChild.setAttribute("href", `#look-${look}`);
    });
    this.spots(state).forEach((spot, index) => this.put(index, spot));
  }

  /** Show a mover: the corner of its cell, and there its figure. @param {number} index @param {number[]} spot */
  put(index, [left, top, x, y, scale]) {
    const group = this.moving[index];
    group.setAttribute("transform", `translate(${left} ${top})`);
    group.firstElementChild.setAttribute("transform", `translate(${x} ${y}) scale(${scale})`);
  }

  /**
   * Return where the movers are drawn: smaller, in a corner, where they share their cell.
   *
   * @param {number} state
   * @returns {number[][]}
   */
  spots(state) {
    const configuration = this.game.configurationOf(state);
    const cells = this.movers.map(({ cells: places, values }) => places[values[configuration]][0]);
    const taken = new Set([state % this.game.cells, ...this.game.things.lying(configuration)]);
    return cells.map((cell, index) => {
      const before = cells.slice(0, index).filter((other) => other === cell).length;
      const isAlone = !taken.has(cell) && cells.indexOf(cell) === cells.lastIndexOf(cell);
      const [scale, dx, dy] = COMMON.spots[isAlone ? 0 : 1 + (before % (COMMON.spots.length - 1))];
      const [left, top] = this.game.corner(...this.game.place(cell));
      return [left, top, COMMON.cell / 2 + dx, COMMON.cell / 2 + dy, scale];
    });
  }

  /**
   * Return where the movers are between two states, for a part of the way; far ones jump.
   *
   * @param {number} from
   * @param {number} to
   * @param {number} part
   * @returns {number[][]}
   */
  between(from, to, part) {
    const [before, after] = [this.spots(from), this.spots(to)];
    return before.map((spot, index) => {
      const end = after[index];
      const isFar = Math.hypot(end[0] - spot[0], end[1] - spot[1]) > 1.01 * COMMON.cell;
      return isFar ? spot : spot.map((length, place) => length + part * (end[place] - length));
    });
  }
}

/** @param {number} number */
export function lookElement(number) {
  return element("use", { href: `#look-${number}` });
}

/**
 * Return the definitions of a picture with things, and the groups that show them.
 *
 * @param {LevelData} data
 * @param {Painter} painter
 */
export function thingElements({ things = [], picture }, painter) {
  const looks = list(picture.looks ?? []).map((look, index) =>
    element("g", { id: `look-${index}` }, ...painter.layer(look)),
  );
  const marks = list(picture.marks ?? []).map((mark) => element("g", {}, ...painter.layer(mark)));
  const side = COMMON.cell;
  // Each reaches under the next ones: nothing shines through between them.
  const tiles = list(picture.tiles ?? []).map((tile) =>
    element("rect", { width: side + 0.5, height: side + 0.5, fill: painter.color(tile) }),
  );
  const still = things.filter((thing) => !moves(thing)).map(() => element("g", {}));
  const moving = things
    .filter(moves)
    .map(({ label }) => element("g", {}, element("use", {}), ...(label < 0 ? [] : [lookElement(label)])));
  return {
    definitions: [...looks, element("g", { id: "marks" }, ...marks), element("g", { id: "tiles" }, ...tiles)],
    still: element("g", { id: "things" }, ...still),
    moving: element("g", { id: "movers" }, ...moving),
  };
}

/** The values and optimal actions in a level's picture: of the configuration at hand. */
export class MarksLayer {
  /** @param {Game} game @param {SVGElement} svg */
  constructor(game, svg) {
    this.game = game;
    this.shapes = [...svg.querySelector("#marks").children];
    this.tiles = [...svg.querySelector("#tiles").children];
    this.layers = ["heat", "values", "policy", "never"].map((name) => svg.querySelector(`#${name}`));
    this.cells = svg.querySelector("#cells");
    this.shown = this.layers.map(() => []);
  }

  /** Show the marks of all cells in a configuration, in the layers that are visible. */
  stand(configuration = this.game.configuration) {
    if (this.shapes.length === 0) return;
    const { data, cells } = this.game;
    const never = data.picture.never ?? -1;
    this.layers.forEach((layer, index) => {
      if (layer.classList.contains("hidden")) return;
      const numbers = this.game.marks(layer.id === "policy" ? "policy" : "values", configuration);
      for (let cell = 0; cell < cells; cell++) {
        const mark = numbers[cell] ?? -1;
        this.put(layer, index, cell, (mark === never) === (layer.id === "never") ? mark : -1);
      }
    });
  }

  /** @param {Element} layer @param {number} index @param {number} cell @param {number} mark */
  put(layer, index, cell, mark) {
    const shown = this.shown[index];
    if ((shown[cell]?.mark ?? -1) === mark) return;
    shown[cell]?.shape.remove();
    const [left, top] = this.game.corner(...this.game.place(cell));
    const isHeat = layer.id === "heat";
    /** @type {any} */
    const shape = (isHeat ? this.tiles : this.shapes)[mark]?.cloneNode(true) ?? element("g", {});
    shape.setAttribute("transform", `translate(${left} ${top})`);
    (isHeat ? this.cells : layer).append(shape);
    shown[cell] = { mark, shape };
  }
}
