// The picture: the level, and the robot moving in it.

import { need, whole } from "./checks.js";
import { COMMON } from "./common.js";
import { SIDES } from "./game.js";
import { channelsOf, element, FONT, Painter, painterOf } from "./paint.js";
import { MarksLayer, ThingsLayer, thingElements } from "./things.js";

const CONFETTI = 16;
const CONFETTI_TIME = 900; // Milliseconds.
const GLIDE = 220; // Milliseconds from cell to cell, at the usual speed.

/** Return the picture of a level as an SVG element; `symbols` are those of the robot. */
export function levelPicture(data, symbols = sprites(data.robot)) {
  const { title, picture, shown } = data;
  need(picture !== null && typeof picture === "object");
  const { layers, palette } = picture;
  need(layers !== null && typeof layers === "object" && layers.base !== undefined);
  const [width, height] = [whole(picture.width, 1, 1e7), whole(picture.height, 1, 1e7)];
  whole(picture.legend ?? 0, 0, height - 1);
  const painter = painterOf(picture);
  // Parts of links that were made before have fewer layers.
  const layer = (name) => painter.layer(layers[name] ?? []);
  const things = thingElements(data, painter);
  const answer = (id, name = id, ...below) =>
    element("g", { id, class: shown.includes(name) ? undefined : "hidden" }, ...below, ...layer(id));
  return element(
    "svg",
    {
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: "img",
      "aria-describedby": "alt",
      "font-family": FONT,
      "stroke-linejoin": "round",
    },
    element("title", {}, title),
    element("desc", { id: "alt" }, data.alt ?? ""),
    element("defs", {}, ...symbols, ...things.definitions),
    element(
      "g",
      { id: "ground", class: isDark(palette[0]) ? "dark" : undefined },
      ...layer("base"),
      answer("heat", "values", element("g", { id: "cells" }), ...legends(data, painter)),
      element("g", { id: "never" }),
      ...layer("grid"),
      element("g", { id: "signs" }, ...layer("signs")),
      element("g", { id: "beside" }, ...layer("beside")),
      element("g", { id: "places" }, ...layer("places")),
    ),
    things.still,
    answer("policy"),
    answer("values"),
    element("g", { id: "robot" }, element("use", { width: COMMON.cell, height: COMMON.cell })),
    things.moving,
  );
}

/** Return the legends of an agent's values and of its costs, of which one is shown. */
function legends({ agent }, painter) {
  const found = { "value-scale": agent?.legend, "cost-scale": agent?.costs?.legend };
  return Object.entries(found).map(([id, layer]) => element("g", { id }, ...painter.layer(layer ?? [])));
}

/** Return whether a colour, such as that of the cells, is dark. */
function isDark(given) {
  const [red, green, blue] = channelsOf(given);
  return 0.3 * red + 0.6 * green + 0.1 * blue < 100;
}

/** Return the robot's symbols for all poses and phases, in the colours of a level.
 *  Colours that the level does not change are their own names. */
export function sprites(robot) {
  const palette = COMMON.palette.map((name) => robot[COMMON.robot.indexOf(name)] ?? name);
  const painter = new Painter(palette);
  const all = [[], []]; // Each picture is told by what differs from the one two before.
  return COMMON.sprites.flatMap((phases, pose) =>
    phases.map((steps, phase) => {
      const numbers = steps.map((step, at) => step + (all.at(-2)[at] ?? 0));
      all.push(numbers);
      const group = [0, 0, numbers.map((number) => COMMON.shapes[number])];
      return element("symbol", { id: `pose-${pose}-${phase}` }, ...painter.layer([group]));
    }),
  );
}

/** Return by how many columns and rows a move leads to the east and to the south. @param {number} move */
function shiftOf(move) {
  /** @type {(ahead: string, back: string) => number} */
  const way = (ahead, back) => Number(SIDES[move].includes(ahead)) - Number(SIDES[move].includes(back));
  return [way("east", "west"), way("south", "north")];
}

/** The picture of a game in the view that shows it. */
export class Picture {
  constructor(game, svg, view) {
    this.game = game;
    this.view = view;
    this.robot = svg.querySelector("#robot");
    this.sprite = this.robot.querySelector("use");
    this.things = new ThingsLayer(game, svg);
    this.marks = new MarksLayer(game, svg);
    this.calm = view.calm;
    this.running = null;
    this.svg = svg;
    view.show(
      svg,
      game.data.exits.map((exit) => game.corner(...game.place(exit))),
    );
    this.showAnswers();
  }

  /** Whether values or optimal actions are seen. */
  get showsAnswers() {
    return this.svg.querySelector(":is(#values, #policy):not(.hidden)") !== null;
  }

  /** Show the values and optimal actions that are switched on, and the legend only beside values. */
  showAnswers() {
    const { width, height, legend = 0 } = this.game.data.picture;
    const isShown = !this.svg.querySelector("#values").classList.contains("hidden");
    const high = isShown ? height : height - legend;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${high}`);
    this.svg.setAttribute("height", high);
    this.marks.stand();
    this.view.measure();
  }

  /** Show things and answers in another configuration; the robot stays. */
  look(configuration) {
    this.things.stand(configuration * this.game.cells + (this.game.state % this.game.cells));
    this.marks.stand(configuration);
  }

  /** Show the robot at a place, in a pose and a phase of its move. */
  draw([x, y], pose, phase = 0) {
    const [left, top] = this.game.corner(x, y);
    const number = Math.round(phase * COMMON.phases) % COMMON.phases;
    this.robot.setAttribute("transform", `translate(${left.toFixed(2)} ${top.toFixed(2)})`);
    this.sprite.setAttribute("href", `#pose-${pose}-${number}`);
  }

  /** Show the state of the game. */
  stand() {
    const { state, standing } = this.game;
    this.stop();
    this.robot.dataset.state = state;
    this.draw(this.game.place(state), standing);
    this.things.stand(state);
    this.marks.stand();
    this.view.follow();
  }

  /** Throw confetti where the robot is, unless less motion is wanted. */
  celebrate() {
    if (this.calm.matches) return;
    const [x, y] = this.game.corner(...this.game.place(this.game.state).map((at) => at + 0.5));
    for (let at = 0; at < CONFETTI; at++) {
      const bit = element("circle", { cx: x, cy: y, r: 3 + (at % 3), class: "confetti" });
      this.svg.append(bit);
      const transform = `rotate(${at / CONFETTI}turn) translate(${COMMON.cell * (0.7 + 0.3 * (at % 3))}px)`;
      const flight = bit.animate({ opacity: [1, 1, 0], transform: ["none", transform] }, CONFETTI_TIME);
      flight.onfinish = () => bit.remove();
    }
  }

  stop() {
    cancelAnimationFrame(this.running);
    this.running = null;
  }

  /** Move the robot as a step did, and call `then` when it has arrived. */
  go({ from, move, next, event, pose, after }, then) {
    const start = this.game.place(from);
    const end = this.game.place(next);
    const shift = [end[0] - start[0], end[1] - start[1]];
    const duration = this.calm.matches ? 0 : GLIDE / this.game.data.speed;
    const toWall = event === "bump" || (event === "bounce" && shift.every((length) => length === 0));
    this.stop();
    this.robot.dataset.state = next;
    this.things.stand(from);
    let begin = null;
    const frame = (now) => {
      begin ??= now;
      const phase = duration ? Math.min(1, (now - begin) / duration) : 1;
      const eased = phase * phase * (3 - 2 * phase);
      const reach = toWall ? 0.13 * Math.sin(Math.PI * phase) : eased;
      const [dx, dy] = toWall ? shiftOf(move) : shift;
      const isThere = phase === 1;
      const place = isThere ? end : [start[0] + reach * dx, start[1] + reach * dy];
      const isStill = shift.every((length) => length === 0);
      this.draw(place, isThere ? after : pose, isThere || isStill ? 0 : phase);
      this.things.between(from, next, eased).forEach((spot, index) => this.things.put(index, spot));
      this.running = isThere ? null : requestAnimationFrame(frame);
      if (isThere) {
        this.things.stand(next);
        this.marks.stand();
        this.view.follow();
        then();
      }
    };
    this.running = requestAnimationFrame(frame);
  }
}
