// Learn: an algorithm at work, in the picture of the player and in a panel of its own.

import { COMMON } from "./common.js";
import { copyText } from "./dom.js";
import { capital, formatted } from "./game.js";
import { chart, inPython, LearnedLayer, toldUpdate } from "./learned.js";
import { Learner, USUAL } from "./learner.js";

const MOST_STATES = 5000;
const FRAME = 8; // Milliseconds of a frame in which it learns.
const SMOOTH = 20; // Milliseconds from frame to frame, unless a picture takes long to paint.
const REST = 4; // How many times as long the next picture waits after a longer frame.
const CHARTS = 100; // Milliseconds from one picture of the charts to the next.
/** @type {[string, number][]} Steps a second; 0 for a sweep or an episode in each frame. */
const SPEEDS = [
  ["2 a second", 2],
  ["10 a second", 10],
  ["60 a second", 60],
  ["1 a frame", 0],
  ["fastest", 1e9],
];
const LIVE = ["step_size", "epsilon", "planning_steps"]; // What may change while it runs.
const LEARN_KEYS = { " ": "run", arrowright: "step", arrowdown: "unit", r: "again", n: "luck", f: "faster" };
const OTHER_KEYS = "vbe0+=-"; // They do what they do otherwise.

/** Return the value of an option's field. */
const chosenIn = (field) => ({ checkbox: field.checked, range: Number(field.value) })[field.type] ?? field.value;

/** The mode of a page in which it learns. */
export class Learning {
  /**
   * @param {(configuration: number) => void} showSets Tells for what is held the picture shows values.
   * @param {Document | ShadowRoot} root What has the panel.
   * @param {(run: string) => boolean} keepRun Keeps what is learned as a link, if there is one.
   */
  constructor(showSets, root = document, keepRun = () => false) {
    this.showSets = showSets;
    this.keepRun = keepRun;
    /** @type {(id: string) => any} */
    this.find = (id) => root.getElementById(id);
    /** @type {any} */
    this.layer = null;
    /** @type {any} */
    this.game = this.picture = this.trail = null; // Of the level at hand.
    this.usual = USUAL;
    this.options = { ...USUAL };
    this.panel = this.find("learn");
    this.python = this.find("learn-python");
    this.details = this.python.parentElement;
    this.commands = {
      run: () => this.run(!this.isRunning),
      step: () => this.advance(this.learner.step()),
      unit: () => this.advance(this.learner.finish()),
      again: () => this.begin(),
      luck: () => this.begin(String(BigInt(this.options.seed) + 1n)),
      faster: () => this.faster(),
      copy: (button) => this.copy(this.python.textContent, button),
      link: (button) => this.copy(location.href, button),
    };
    for (const button of this.panel.querySelectorAll("[data-learn]")) {
      button.addEventListener("click", () => this.commands[button.dataset.learn](button));
    }
    for (const name of ["input", "change"]) {
      this.panel.addEventListener(name, ({ target }) => this.change(target, name === "change"));
    }
    this.details.addEventListener("toggle", () => this.isOn && this.showNumbers());
  }

  get isOn() {
    return this.layer !== null;
  }

  /** Get to know the game of another level. */
  offer(game, picture, trail) {
    this.leave();
    Object.assign(this, { game, picture, trail });
    const { data } = game;
    this.usual = { ...USUAL, discount: data.discount ?? 1 };
    Object.assign(this.options, { discount: this.usual.discount, exploring_starts: false });
    const actions = this.panel.querySelector("[data-option=actions]");
    this.canTurn = data.turns !== undefined && 4 * data.possible.length <= MOST_STATES;
    actions.options[2]?.remove();
    if (this.canTurn) actions.add(new Option("Turns, and forward", "turns"));
    this.find("learn-on").hidden = data.rows === undefined || !(data.learn ?? data.policy !== null);
  }

  /** Take over what a link tells to learn, as far as it can be chosen here; return its seed, or null. */
  follow(run) {
    if (!run.has("learn") || this.find("learn-on").hidden) return null;
    this.options = { ...this.usual };
    run.set("algorithm", run.get("learn"));
    for (const field of this.panel.querySelectorAll("[data-option]")) {
      const text = run.get(field.dataset.option);
      const given = field.type === "range" ? Number.parseFloat(text) : text;
      if (given === null || (field.type === "range" && !Number.isFinite(given))) continue;
      // The field refuses what it does not offer.
      Object.assign(field, { value: given, checked: given === "true" });
      if (field.selectedIndex !== -1) this.options[field.dataset.option] = chosenIn(field);
    }
    return /^\d{1,40}$/.test(run.get("seed")) ? run.get("seed") : this.usual.seed;
  }

  /** Why the level is not learned; empty if it is. */
  get refusal() {
    const states = this.game.data.possible.length;
    if (states <= MOST_STATES) return "";
    return `Only levels of up to ${MOST_STATES} states are learned here; this one has ${states}.`;
  }

  /** Begin to learn in place of the game, if the level is small enough. */
  enter() {
    const { refusal } = this;
    if (refusal !== "") {
      this.say(refusal);
      return;
    }
    this.attach();
    this.put(true);
    const { game } = this;
    if (game.isTurning !== (this.options.actions === "turns")) {
      this.options.actions = game.isTurning && this.canTurn ? "turns" : "moves";
    }
    this.begin(this.find("seed").value);
    this.picture.showAnswers();
  }

  /** Have the picture show what is learned in the place of what is exact. */
  attach() {
    const { game, picture } = this;
    this.layer = new LearnedLayer(game, picture.svg);
    this.marks = picture.marks;
    picture.marks = this.layer;
  }

  /** Go back to the game. */
  leave() {
    if (!this.isOn) return;
    this.run(false);
    this.layer.remove();
    this.layer = null;
    this.picture.marks = this.marks;
    this.put(false);
    this.picture.showAnswers();
  }

  /** Show or hide the panel, and what else the mode changes. */
  put(isOn) {
    this.panel.hidden = !isOn;
    this.panel.closest(".player").classList.toggle("learning", isOn);
    for (const name of ["values", "policy"]) {
      const button = this.find(`show-${name}`);
      button.setAttribute("aria-pressed", !this.find(name).classList.contains("hidden"));
      if (isOn) button.hidden = false;
    }
    if (isOn) this.find("policy-name").textContent = "Greedy actions";
  }

  /** Forget what was learned, and begin again. */
  begin(seed = this.options.seed) {
    this.run(false);
    this.options.seed = this.find("seed").value = seed;
    const { game } = this;
    game.isTurning = this.options.actions === "turns";
    this.options.exploring_starts &&= !(game.data.things || game.isTurning);
    this.learner = new Learner(game.data, this.options);
    this.isMixed = false;
    this.showOptions();
    const { problem } = this.learner;
    [game.state, game.heading] = problem.split(problem.data.starts[0]);
    this.layer.begin(this.learner);
    this.show(null);
    this.showAll();
    this.keep();
    this.say(`Nothing is learned yet. The seed is ${seed}.`);
  }

  /** Have the address of the page lead here: to the algorithm, and to what differs from how one begins otherwise. */
  keep() {
    const { algorithm, ...given } = this.options;
    const run = new URLSearchParams({ learn: algorithm });
    for (const [name, value] of Object.entries(given)) if (value !== this.usual[name]) run.set(name, String(value));
    this.find("learn-link").hidden = !this.keepRun(String(run));
  }

  /** Show and tell a single update; null after the end. */
  advance(update) {
    this.run(false);
    this.layer.chosen = null;
    this.show(update, true);
    this.showAll();
    this.say(update === null ? this.ending : toldUpdate(this.game, this.learner, update));
  }

  /** Let it run, or stop it. */
  run(wanted) {
    if (this.isRunning === wanted) return;
    this.isRunning = wanted;
    cancelAnimationFrame(this.frame);
    this.find("learn-run").setAttribute("aria-pressed", wanted);
    this.find("learn-run").firstElementChild.textContent = wanted ? "Stop" : "Run";
    if (wanted) {
      this.due = 1;
      this.wait = this.shown = 0;
      this.update = null;
      this.last = this.charted = performance.now();
      this.frame = requestAnimationFrame((now) => this.tick(now));
    } else if (this.isOn && this.learner) {
      this.show(this.update);
      this.showAll();
      this.find("spoken").textContent = this.find("learn-numbers").textContent;
    }
  }

  /** Learn for a frame. */
  tick(now) {
    const [, rate] = SPEEDS[this.find("learn-speed").value];
    const { learner } = this;
    const { number } = learner;
    const end = performance.now() + FRAME;
    const took = now - this.last;
    if (took > SMOOTH) this.wait = Math.max(this.wait, REST * took);
    this.due = rate > 0 ? Math.min(this.due + (rate * Math.max(0, took)) / 1000, Math.max(1, rate)) : Infinity;
    this.last = now;
    for (let steps = 1; this.due >= 1; steps++) {
      this.update = learner.step();
      this.isStale = true;
      if (this.update === null) {
        this.run(false);
        this.say(this.ending);
        return;
      }
      this.due -= 1;
      if (steps % 32 === 0 && performance.now() > end) break;
      if (rate === 0 && learner.number > number) break;
    }
    if (this.isStale && now >= this.shown + this.wait) {
      this.shown = now;
      this.wait /= 4; // It may have been another reason.
      this.isStale = false;
      this.show(this.update, rate === SPEEDS[0][1]);
      this.find("message").textContent = toldUpdate(this.game, learner, this.update);
      this.showNumbers();
      if (now - this.charted > CHARTS) this.showCharts(now);
    }
    this.frame = requestAnimationFrame((later) => this.tick(later));
  }

  /** Why it does not go on. */
  get ending() {
    return `Nothing changes any more after ${this.learner.number} ${this.learner.unit}s.`;
  }

  /** Show an update in the picture: the robot in its episode, and the outline of what is learned otherwise. */
  show(update, isSlow = false) {
    const { game, layer, picture, trail } = this;
    const { way, problem } = this.learner;
    const { state, step } = update ?? {};
    const before = game.number;
    if (way.length > 0) [game.state, game.heading] = problem.split(way.at(-1));
    game.past = way.slice(-200, -1).map((each) => ({ state: problem.split(each)[0] }));
    const here = step === undefined ? state : undefined;
    if (isSlow && here !== undefined) {
      const [seen, heading] = problem.split(here);
      layer.chosen = game.configurationOf(seen);
      game.heading = heading;
    }
    if (update === null || game.number !== before) picture.stand();
    else layer.stand();
    trail.stand();
    if (isSlow && step !== undefined) {
      const [[from, heading], [next, looking]] = [step.state, step.next].map((each) => problem.split(each));
      const [side, turn] = problem.way(step.action, heading);
      const { event } = game.eventOf(step.code);
      const pose = heading === null ? step.pose : COMMON.headings[Number(event === "skid")][looking];
      picture.go({ from, move: turn === 0 ? side : 0, next, event, pose, after: pose }, () => {});
    }
    layer.point(here ?? way.at(-1));
    this.showSets(layer.shown);
  }

  showAll() {
    this.showNumbers();
    this.showCharts();
  }

  /** Tell how far it is. */
  showNumbers() {
    const { learner, game } = this;
    const { starts } = learner.problem.data;
    const [value, exact] = [learner.values, learner.exact].map((values) =>
      starts.reduce((sum, state) => sum + values[state] / starts.length, 0),
    );
    this.goal = exact;
    this.find("learn-numbers").textContent =
      `${capital(learner.unit)} ${learner.number} · value at the start ${formatted(value)}, exact ${formatted(exact)}`;
    if (!this.details.open) return;
    const warning = this.isMixed ? "# Something was changed while this ran: Python's numbers differ.\n" : "";
    this.python.textContent = warning + inPython(game.data, learner);
  }

  showCharts(now = performance.now()) {
    this.charted = now;
    const { unit, returns, errors, changes } = this.learner;
    this.find("learn-charts").replaceChildren(
      ...(returns.length > 0 ? [chart("Return", returns, unit, changes, this.goal)] : []),
      chart("Error of the values", errors, unit, changes),
    );
  }

  /** Show the options, those that the algorithm has. */
  showOptions() {
    for (const field of this.panel.querySelectorAll("[data-option]")) {
      const value = this.options[field.dataset.option];
      if (field.type === "checkbox") field.checked = value;
      else field.value = value;
      this.showOutput(field, value);
    }
    for (const label of this.panel.querySelectorAll("[data-for]")) {
      label.hidden = !label.dataset.for.split(" ").includes(this.options.algorithm);
    }
    if (this.game.data.things || this.game.isTurning)
      this.panel.querySelector('[data-option="exploring_starts"]').parentElement.hidden = true;
    this.find("learn-unit").textContent = capital(this.learner.unit);
    this.find("learn-step").textContent = this.learner.unit === "sweep" ? "State" : "Step";
    this.showOutput(this.find("learn-speed"));
  }

  showOutput(field, value = Number(field.value)) {
    if (field.type !== "range") return;
    const isSpeed = field.dataset.option === undefined;
    const text = isSpeed ? SPEEDS[value][0] : formatted(value);
    field.parentElement.querySelector("output").textContent = text;
    field.setAttribute("aria-valuetext", text);
  }

  /** Take over an option; most of them begin the run again, once they are chosen. */
  change(field, isChosen) {
    this.showOutput(field);
    const { option } = field.dataset;
    const isLive = LIVE.includes(option);
    if (option === undefined || !(isLive || isChosen)) return;
    this.options[option] = chosenIn(field);
    if (!isLive) this.begin();
    else if (isChosen) this.keep();
    if (this.learner.options[option] !== this.options[option]) {
      this.learner.options[option] = this.options[option];
      this.isMixed = this.learner.way.length > 0;
      this.showNumbers();
    }
  }

  faster() {
    const speed = this.find("learn-speed");
    speed.value = (Number(speed.value) + 1) % SPEEDS.length;
    this.showOutput(speed);
    this.run(true);
  }

  /** Do what a key means here; return false for keys that do what they otherwise do. */
  press(event) {
    if (event.target.matches("select, [type=range]")) return true;
    const key = event.key.toLowerCase();
    const command = LEARN_KEYS[key];
    if (command === undefined) return !OTHER_KEYS.includes(key);
    event.preventDefault();
    if (!event.repeat || key.startsWith("arrow")) this.commands[command]();
    return true;
  }

  async copy(text, button) {
    await copyText(text, button);
    this.say("Copied.");
  }

  /** Tell something, also to screen readers. */
  say(text) {
    Object.assign(this.find("message"), { textContent: text }).dataset.kind = "";
    this.find("spoken").textContent = text.replace("←", "becomes");
  }
}
