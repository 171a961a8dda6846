// What a learner knows, in the picture, in charts and in words.

import { COMMON } from "./common.js";
import { formatted, SIDES } from "./game.js";
import { element, painterOf } from "./paint.js";

const ANSWERS = ["heat", "values", "policy"];
const SCALE = ["#fffbd8", "#3496be"]; // Of pages that know no values.
const SIZE = 10.5; // Of numbers, as those of the optimum have it.
const CHART = { width: 300, height: 96, left: 8, right: 292, top: 26, bottom: 76 };
const MOST_POINTS = 300; // Of a line in a chart.
const MOST_NUMBERED = 32; // Columns or rows of levels with numbers, and with rims around arrows.

/** Values and greedy actions of a learner, in the place of those of the optimum. */
export class LearnedLayer {
  constructor(game, svg) {
    this.game = game;
    this.old = ANSWERS.map((id) => svg.querySelector(`#${id}`));
    this.own = this.old.map((layer) => layer.cloneNode(layer.id === "heat"));
    this.own.forEach((layer, index) => {
      layer.classList.remove("hidden");
      this.old[index].replaceWith(layer);
    });
    const { palette, scale = SCALE } = game.data.picture;
    this.colors = painterOf({ ...game.data.picture, palette, scale }).scale;
    const side = COMMON.cell;
    this.here = element("rect", { id: "here", x: 3, y: 3, width: side - 6, height: side - 6, rx: 5 });
    svg.querySelector("#robot").before(this.here);
    this.ground = this.own[0].querySelector("#cells");
    this.ground.replaceChildren();
    const inks = svg.querySelector(".dark") ? ["#000", "#fff"] : ["#fff", "#000"];
    const isLarge = Math.max(game.data.width, game.data.height) > MOST_NUMBERED;
    this.cells = Array.from({ length: game.cells }, (_, cell) => {
      const transform = this.at(cell);
      const tile = element("rect", { width: side + 0.5, height: side + 0.5, transform });
      const number = element("text", { x: 32, y: 57, "text-anchor": "middle", "font-weight": "bold", transform });
      this.ground.append(tile);
      if (!isLarge) this.own[1].append(number);
      return { tile, number };
    });
    /** The arrows of each row are few elements, which are painted sooner than one for each cell. */
    this.rows = Array.from({ length: game.data.height }, (_, row) => {
      const arrows = inks.map((ink, index) =>
        element("path", {
          transform: this.at(row * game.data.width),
          fill: ink,
          stroke: ink,
          "stroke-width": index ? 2.8 : 6.4,
          "stroke-linecap": "round",
        }),
      );
      this.own[2].append(...arrows.slice(Number(isLarge)));
      return { arrows, paths: [], isStale: false };
    });
  }

  /** Give the picture back what it had. */
  remove() {
    this.own.forEach((layer, index) => layer.replaceWith(this.old[index]));
    this.here.remove();
  }

  /** Return where the cell of a state is, as a transformation. */
  at(state) {
    return `translate(${this.game.corner(...this.game.place(state)).join(" ")})`;
  }

  /** Show a learner, in colours for the range of its exact values. */
  begin(learner) {
    this.learner = learner;
    this.seen = new Set(learner.problem.reached);
    const { reached } = learner.problem;
    const known = reached.flatMap((state) => [learner.exact[state], learner.values[state]]).filter(Number.isFinite);
    this.low = known.reduce((least, value) => Math.min(least, value), Infinity);
    this.high = known.reduce((most, value) => Math.max(most, value), -Infinity);
    this.chosen = null;
    const [low, high] = this.own[0].querySelectorAll("text");
    if (!this.game.data.picture.legend || high === undefined) return; // Of a single value, there is no scale.
    [...low.previousElementSibling.children].forEach((part, index, { length }) =>
      part.setAttribute("fill", this.color(this.low + ((index + 0.5) / length) * (this.high - this.low))),
    );
    low.textContent = textOf(this.low);
    high.textContent = textOf(this.high);
  }

  /** Return a value's colour: where there are both signs, that of 0 is in the middle. */
  color(value) {
    const { low, high } = this;
    const both = low < 0 && high > 0 ? Math.max(-low, high) : 0;
    const share = both > 0 ? (value + both) / (2 * both) : (value - low) / (high - low || 1);
    return this.colors[Math.round((this.colors.length - 1) * Math.min(1, Math.max(0, share)))];
  }

  /** Outline the cell of a state, or none. */
  point(state) {
    const isSeen = state !== undefined && Math.floor(state / this.game.cells) === this.page;
    this.here.setAttribute("transform", isSeen ? this.at(state) : "scale(0)");
  }

  /** Show what is known in a configuration: that of the state at hand, or one that was chosen. */
  stand(configuration = this.chosen) {
    this.chosen = configuration;
    this.shown = configuration ?? this.game.configuration;
    // For each heading of a robot that turns, there are other answers.
    this.page = this.shown * this.learner.problem.headings + (this.game.heading ?? 0);
    const [heat, values, policy] = this.own.map((layer) => !layer.classList.contains("hidden"));
    this.cells.forEach((cell, index) => {
      const state = this.page * this.cells.length + index;
      const isSeen = this.seen.has(state) && this.learner.knows(state);
      if (heat || values) this.showValue(cell, isSeen ? this.learner.values[state] : null);
      if (policy) this.showActions(index, isSeen ? this.learner.best(state) : []);
    });
    for (const row of this.rows) {
      if (row.isStale) for (const arrow of row.arrows) arrow.setAttribute("d", row.paths.join(""));
      row.isStale = false;
    }
  }

  showValue(cell, value) {
    if (cell.value === value) return;
    cell.value = value;
    const [text, color] = value === null ? ["", "none"] : [textOf(value), this.color(value)];
    if (color !== cell.color) {
      const [red, green, blue] = (color.match(/\d+/g) ?? []).map(Number);
      cell.tile.setAttribute("fill", color);
      cell.number.setAttribute("fill", 0.3 * red + 0.59 * green + 0.11 * blue > 125 ? "#000" : "#fff");
    }
    if (text !== cell.text) {
      cell.number.textContent = text;
      cell.number.setAttribute("font-size", Math.min(SIZE, 96 / Math.max(1, text.length)));
    }
    Object.assign(cell, { text, color });
  }

  showActions(index, best) {
    const [x, y] = this.game.place(index);
    const row = this.rows[y];
    const { problem } = this.learner;
    const arrows = best.map((action) => arrowTo(x * COMMON.cell, ...problem.way(action, this.game.heading)));
    const path = arrows.join("");
    row.isStale ||= path !== (row.paths[x] ?? "");
    row.paths[x] = path;
  }
}

/** Return a value as text. */
function textOf(value) {
  return formatted(Math.round(100 * value) / 100).replace("Infinity", "∞");
}

/** Return the path of an action in a cell, so far from the left: an arrow to a side, or one that turns from it, or a ring. */
function arrowTo(left, side, turn) {
  if (side === 0) return `M${left + 28} 30.5a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z`;
  const angle = ((side > 4 ? side - 4.5 : side - 1) * Math.PI) / 2;
  const [dx, dy] = [Math.sin(angle), -Math.cos(angle)].map((part) => Math.round(100 * part) / 100);
  const at = (along, across) => `${left + 32 + along * dx - across * dy} ${30.5 + along * dy + across * dx}`;
  if (turn !== 0) {
    const [end, tip] = [7 * turn, 13.5 * turn];
    return `M${at(-4, 0)}L${at(5, 0)}M${at(5, 0)}L${at(5, end)}M${at(5, tip)}L${at(8.6, end)}L${at(1.4, end)}z`;
  }
  return `M${at(0, 0)}L${at(7, 0)}M${at(13.5, 0)}L${at(7, 3.6)}L${at(7, -3.6)}z`;
}

const strideOf = (values) => Math.ceil(values.length / MOST_POINTS);

/**
 * Return a chart of numbers: errors of values from 0 on, or returns with the mean of several, and a goal.
 *
 * @param {string} title
 * @param {number[]} numbers
 * @param {string} unit
 * @param {Set<number>} changes Where lines tell that the level has changed.
 * @param {number} [goal]
 */
export function chart(title, numbers, unit, changes, goal) {
  const { width, height, left, right, top, bottom } = CHART;
  const isReturn = goal !== undefined;
  const sorted = numbers.filter((number, index) => Number.isFinite(number) && index % strideOf(numbers) === 0);
  sorted.sort((one, other) => one - other);
  // A few bad episodes would press all others together.
  const least = isReturn ? sorted[Math.floor(sorted.length / 50)] : 0;
  const goals = Number.isFinite(goal) ? [goal] : [];
  const low = Math.min(least ?? 0, ...goals);
  const high = Math.max(sorted.at(-1) ?? 0, ...goals);
  const x = (index) => left + (index / Math.max(1, numbers.length - 1)) * (right - left);
  const y = (value) => bottom - ((Math.min(Math.max(value, low), high) - low) / (high - low || 1)) * (bottom - top);
  const line = (values, name) => {
    const stride = strideOf(values);
    const points = values.flatMap((value, index) => {
      const isDrawn = Number.isFinite(value) && (index % stride === 0 || index === values.length - 1);
      return isDrawn ? `${x(index + numbers.length - values.length).toFixed(1)} ${y(value).toFixed(1)}` : [];
    });
    return element("path", { class: name, d: points.length > 0 ? `M${points.join("L")}` : "" });
  };
  const label = (x, y, words, anchor) => element("text", { x, y, "text-anchor": anchor }, words);
  const told = formatted(numbers.at(-1)) + (isReturn ? `, exact ${formatted(goal)}` : "");
  const span = Math.ceil(numbers.length / 20);
  let total = 0;
  const means = numbers.map((number, index) => (total += number - (numbers[index - span] ?? 0)) / span);
  return element(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${title}: ${told}` },
    label(left, 16, title),
    label(right, 16, told, "end"),
    ...[...changes].map((index) => element("path", { class: "change", d: `M${x(index)} ${top}V${bottom}` })),
    line(numbers, isReturn ? "faint" : "line"),
    ...(isReturn ? [line(means.slice(span - 1), "line")] : []),
    ...goals.map((each) => element("path", { class: "goal", d: `M${left} ${y(each)}H${right}` })),
    label(right, height - 6, `${unit} ${numbers.length - Number(!isReturn)}`, "end"),
  );
}

/** Tell an update with its numbers. @param {Game} game @param {any} learner @param {any} update */
export function toldUpdate(game, { problem, options, actions, isPrediction, number }, update) {
  const { names } = problem;
  const { state, action, step, parts, rewards, visits, changed } = update;
  const [was, target, value, ahead] = [update.before, update.target, update.value, update.ahead].map((each) =>
    formatted(each ?? 0),
  );
  // After an operator, a negative number is in parentheses.
  const [less, times] = [was, ahead].map((each) => (each.startsWith("\u2212") ? `(${each})` : each));
  const place = (number) => {
    const [at, heading] = problem.split(number);
    const looking = heading === null ? "" : ` looking ${SIDES[heading + 1]}`;
    const held = game.data.things ? ` with ${game.things.words(game.configurationOf(at)).toLowerCase()}` : "";
    return `[${game.place(at).join(", ")}]${looking}${held}`;
  };
  if (changed !== undefined)
    return `Round ${number}: the policy's exact values, and a better action in ${changed} states.`;
  if (parts) {
    const isTaken = (_, index) => !isPrediction || actions[state][index] > 0;
    const told = parts.map((part, index) => `${names[index]} ${formatted(part)}`).filter(isTaken);
    return `V(${place(state)}) ← ${isPrediction ? "mean" : "max"}(${told.join(", ")}) = ${value}`;
  }
  if (visits) return `V(${place(state)}) ← ${was} + 1/${visits} · (${target} − ${less}) = ${value}`;
  const reward = formatted(step.reward);
  if (state === undefined) return `${place(step.state)}, ${names[step.action]}: reward ${reward}`;
  const [begin, end] = [
    `Q(${place(state)}, ${names[action]}) ← ${was} + ${options.step_size}`,
    `− ${less}) = ${value}`,
  ];
  if (rewards > 1) return `${begin} · (G ${end}, where G = ${target}: ${rewards} rewards, and then ${ahead}`;
  const planned = options.planning_steps > 0 ? `, and ${options.planning_steps} planned` : "";
  return `${begin} · (${reward} + ${formatted(problem.discount)} · ${times} ${end}${planned}`;
}

/** Return the program that gives a run's numbers in Python. @param {LevelData} data @param {any} learner */
export function inPython({ code, title }, { options, number, unit, isPrediction }) {
  const { algorithm, discount, actions, policy, seed } = options;
  const count = Math.max(1, number);
  const given = { discount, actions: `"${actions}"` };
  if (isPrediction) given.policy = `"${policy}"`;
  if (unit === "episode") Object.assign(given, { episodes: count, seed });
  else given.max_sweeps = count;
  if (unit === "episode" && !isPrediction) {
    const { step_size, epsilon, initial, n_steps, planning_steps, exploring_starts } = options;
    Object.assign(given, { step_size, epsilon, initial });
    if (algorithm === "sarsa") given.n_steps = n_steps;
    else Object.assign(given, { planning_steps, exploring_starts: exploring_starts ? "True" : "False" });
  }
  const lines = Object.entries(given).map(([name, value]) => `    ${name}=${value},\n`);
  return (
    `import babyrobot_levels as brl\n\nlevel = brl.load(${JSON.stringify(code ?? title)})\n` +
    `*_, last = brl.${algorithm}(\n    level,\n${lines.join("")})\nprint(last.number, last.values.round(2))\n`
  );
}
