// The player: a level in the elements of `player.html`, and how it is controlled.

import { keepRun, runOf } from "./address.js";
import { byId, html, readOut, showStars } from "./dom.js";
import { Fog, limitSight } from "./fog.js";
import { capital, formatted, GOAL, SIDES } from "./game.js";
import { listenToGestures } from "./gestures.js";
import { downloadPlays, keepName, keepPlay, recallName, seedAfter } from "./kept.js";
import { Learning } from "./learn.js";
import { Legend } from "./legend.js";
import { element, pixels } from "./paint.js";
import { levelPicture, Picture } from "./picture.js";
import { resultFacts, ruleOf, starsOf, verdictOf } from "./result.js";
import { ShownSets } from "./shown.js";
import { offerSounds, sound } from "./sound.js";
import { closedSides, surroundings } from "./speech.js";
import { gameOf, Hands } from "./team.js";
import { lookElement } from "./things.js";
import { Trail } from "./trail.js";
import { View, ZOOM_STEP } from "./view.js";
import { Views } from "./views.js";

const view = new View(byId("stage"), byId("map"));
const legend = new Legend(view, byId("rules"), byId("cell"));

const sets = new ShownSets(byId("sets"), (configuration) => picture.look(configuration));

const views = new Views(showView, (cells) => legend.outline(cells));
const learning = new Learning(showLearned, document, keepRun);
const hands = new Hands(byId("hands"), () => ask());

let game = null;
let picture = null;
let trail = null;
let fog = null;
let isWatching = false;
let timer = null;
let goal = -1; // The cell to which the robot walks; -1 for none.

const WATCHED = {
  best: "Watch the optimal policy",
  random: "Watch the random policy",
  agent: "Watch the agent",
  sight: "Watch the best agent",
};

/** Show a level and start to play it; nothing changes if that fails. */
export function showLevel(data) {
  const svg = levelPicture(data);
  watch(false);
  picture?.stop();
  game = gameOf(data);
  limitSight(game);
  picture = new Picture(game, svg, view);
  trail = new Trail(game, svg);
  fog = new Fog(game, svg);
  legend.show(game);
  sets.begin(game);
  views.begin(game);
  hands.begin(game);
  learning.offer(game, picture, trail);
  for (const name of ["values", "policy"]) {
    byId(`show-${name}`).setAttribute("aria-pressed", data.shown.includes(name));
  }
  byId("turning").hidden = data.turns === undefined;
  const { discount = 1, goal } = data;
  byId("return-name").textContent = discount < 1 ? `Return, discount ${discount}` : "Return";
  const isFoggy = game.sight !== null;
  byId("show-belief").hidden = byId("sure").hidden = !isFoggy;
  byId("show-belief").setAttribute("aria-pressed", "false");
  // What is around, and where the exits lie, is what one has to find out.
  byId("look").hidden = isFoggy;
  view.stage.parentElement.classList.toggle("foggy", isFoggy);
  showActions();
  showTrail();
  begin(seedAfter(data.seed, data.seed), goal ?? GOAL + game.things.needs(game.configuration));
  learnAddressed();
}

/** Learn, if the address of the page tells what. */
export function learnAddressed() {
  const seed = learning.follow(runOf(location.hash));
  if (seed === null) return;
  learning.leave();
  game.isTurning = learning.options.actions === "turns";
  begin(seed);
  learn();
}

/** Show the controls of the robot's actions, and what is known about them. */
function showActions() {
  const { data, isTurning, known } = game;
  byId("turning").setAttribute("aria-pressed", isTurning);
  for (const place of document.querySelectorAll("[data-mode]")) {
    place.hidden = (place.dataset.mode === "turns") !== isTurning;
  }
  for (const place of document.querySelectorAll(".diagonal")) place.hidden = game.actions === 5;
  views.stand();
  byId("watch").hidden = game.walker === null;
  byId("watched").textContent = WATCHED[game.walker];
  byId("best").textContent = known.best;
  byId("best").parentElement.hidden = known.best === "";
  byId("hint").hidden = known.policy === null && game.walker !== "sight";
  byId("show-values").hidden = known.policy === null;
  byId("show-policy").hidden = (known.policy === null && data.agent === undefined) || isTurning;
}

/** Show the optimum, the agent, or what the agent costs, as one chose. */
function showView() {
  watch(false);
  showActions();
  picture.showAnswers();
  showSets();
}

export function factElements([name, value]) {
  return [html("dt", {}, name), html("dd", {}, html("bdi", {}, value))];
}

/** Show the numbers of the episode, a message, and the result at the end. */
function show(message, kind = "") {
  byId("steps").textContent = game.steps;
  byId("return").textContent = formatted(game.total);
  const line = byId("message");
  line.textContent = message;
  line.dataset.kind = kind;
  speak(message);
  showHeld();
  showSets();
  byId("sure").textContent = (game.end === null && game.sight?.told) || "";
  showResult();
  showHint(-1);
  for (const button of document.querySelectorAll("[data-action]")) showButton(button);
}

/** Show on the button of an action whether that side is closed. */
function showButton(button) {
  if (button.closest("[hidden]")) return;
  const isShut = game.end === null && !game.isPossible(Number(button.dataset.action));
  const [name] = button.getAttribute("aria-label").split(",");
  button.classList.toggle("shut", isShut);
  button.setAttribute("aria-label", isShut ? `${name}, closed` : name);
}

/** Tell screen readers what happened, and which sides are closed now. */
function speak(message) {
  readOut(byId("spoken"), game.end === null ? `${message.replace(/[^.!?]$/, "$&.")} ${closedSides(game)}` : message);
}

/** Tell where the robot is, what is around it, and where the exits lie. */
function lookAround() {
  const text = surroundings(game);
  byId("message").textContent = byId("spoken").textContent = text;
  byId("message").dataset.kind = "";
}

/** Show the card of the episode's result if it has ended. */
function showResult() {
  byId("result").hidden = game.end === null;
  if (game.end === null) return;
  const stars = starsOf(game);
  byId("result-title").textContent = verdictOf(game) ?? game.cause + (game.isGood ? "!" : "");
  byId("stars").hidden = byId("result-help").parentElement.hidden = stars === null;
  showStars(byId("stars"), stars ?? 0);
  byId("result-help").textContent = stars === null ? "" : ruleOf(game);
  const count = keepPlay(game);
  byId("download").parentElement.hidden = count === 0;
  byId("download").textContent = count > 1 ? `Download ${count} plays` : "Download";
  byId("result-facts").replaceChildren(...resultFacts(game).flatMap(factElements));
}

/** Highlight an action in the picture and among the buttons; a negative one highlights none. */
function showHint(action) {
  trail.point(action);
  for (const button of document.querySelectorAll("[data-action]")) {
    const isMeant = button.dataset.action === String(game.partOf(action)) && !button.closest("[hidden]");
    button.classList.toggle("hinted", isMeant);
  }
}

/** Show or hide the trail, as one chose. */
function showTrail() {
  trail.group.classList.toggle("hidden", !byId("trail").checked);
}

/** Show for what is held values and optimal actions are shown, while they are. */
function showSets() {
  if (learning.isOn) sets.stand(true, learning.layer.shown);
  else sets.stand((game.known.policy !== null || game.seen !== game.known) && picture.showsAnswers);
}

/** Show what is held while it learns, and for what is held the picture shows what is learned. */
function showLearned(configuration) {
  sets.stand(true, configuration);
  showHeld();
}

/** Show what is held, and what is on. */
function showHeld() {
  const groups = game.things.met(game.configuration);
  byId("held").replaceChildren(...groups.map(([state, found]) => heldElement(capital(state), found)));
  byId("held").hidden = !byId("held").hasChildNodes();
}

function heldElement(title, found) {
  const details = found.map(({ icon: [look, left, top, side], name }) => {
    const box = [left, top, side, side].map(pixels).join(" ");
    return html("dd", {}, element("svg", { viewBox: box, "aria-hidden": true }, lookElement(look)), name);
  });
  if (details.length === 0) details.push(html("dd", { class: "none" }, "nothing"));
  return html("div", {}, html("dt", {}, title), ...details);
}

function watch(wanted) {
  isWatching = wanted;
  goal = -1;
  clearTimeout(timer);
  byId("watch").setAttribute("aria-pressed", wanted);
  if (!wanted) return;
  if (game.end !== null) begin(seedAfter(game.seed, game.nextSeed));
  takeAdvice();
}

function takeAdvice() {
  if (!isWatching) return;
  const action = game.end === null ? game.advice() : -1;
  if (action < 0) {
    watch(false);
    if (game.end === null) show("The agent has no action here.");
    return;
  }
  game.watched += 1;
  take(action);
}

/** Walk to the cell at a point of the window, step by step, until something else happens. */
function walkTo(event) {
  const cell = legend.cellAt(event);
  if (cell < 0 || game.end !== null || (game.robots === undefined && cell === game.state % game.cells)) return;
  watch(false);
  goal = cell;
  if (!walkOn()) show(`There is no free way to [${game.place(cell).join(", ")}].`);
}

function walkOn() {
  const action = goal < 0 || game.end !== null ? -1 : game.towards(goal);
  // Those of a team are moved step by step.
  if (action < 0 || game.robots !== undefined) goal = -1;
  if (action >= 0) choose(action);
  return action >= 0;
}

/** Take a choice of the player, and the step that comes of it. */
function choose(action, keys) {
  const chosen = game.end === null ? game.choose(action, keys) : action;
  if (chosen === null) ask();
  else take(chosen);
}

/** Ask for the action of the next robot. */
function ask() {
  show(game.turn);
}

function take(action) {
  if (game.end !== null) {
    show(`${game.describeEnd()} Retry or take new luck to play again.`, game.end);
    return;
  }
  trail.stand();
  const step = game.step(action);
  const isEnd = game.end !== null;
  show(
    [game.isGood ? "" : game.describeStep(step), isEnd ? game.describeEnd() : game.turn].filter(Boolean).join(". "),
    isEnd ? game.end : step.event,
  );
  sound(isEnd ? (game.isGood ? "won" : "lost") : step.event);
  if (isEnd) document.dispatchEvent(new CustomEvent("episodeend", { detail: game }));
  picture.go(step, () => {
    trail.stand();
    fog.stand();
    if (game.isGood && game.watched === 0) picture.celebrate();
    if (step.event === "bump" || step.hit !== null) goal = -1;
    walkOn();
    if (isWatching) timer = setTimeout(takeAdvice, picture.calm.matches ? 400 : 90);
  });
}

/** Begin the episode of a seed. */
function begin(seed, message = `An episode begins with seed ${seed}.`) {
  game.begin(seed);
  byId("seed").value = seed;
  stand(message);
}

/** Show the state of the game without a move. */
function stand(message) {
  picture.stand();
  trail.stand();
  fog.stand();
  show(message);
}

function undo() {
  watch(false);
  if (game.past.length === 0) {
    show("There is no action to undo.");
    return;
  }
  game.undo();
  stand(
    `Undone: back at [${game.place(game.state).join(", ")}] after ` +
      `${game.steps} step${game.steps === 1 ? "" : "s"}.`,
  );
}

function hint() {
  if (byId("hint").hidden) return;
  watch(false);
  const action = game.hint();
  show(action < 0 ? "There is no hint: the episode has ended." : game.describeHint(action));
  showHint(action);
}

/** Show or hide values, optimal actions, or the shades of what may be. */
function toggle(name) {
  const button = byId(`show-${name}`);
  if (button.hidden) return;
  const isShown = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", isShown);
  for (const layer of name === "values" ? ["heat", name] : [name]) {
    byId(layer).classList.toggle("hidden", !isShown);
  }
  picture.showAnswers();
  showSets();
}

/** Let the robot turn, or move to all sides again: from the start. */
function turn() {
  if (byId("turning").hidden) return;
  watch(false);
  game.isTurning = !game.isTurning;
  showActions();
  begin(game.seed);
}

/** Begin to learn, or play again. */
function learn() {
  if (byId("learn-on").hidden) return;
  watch(false);
  const wasOn = learning.isOn;
  learning.leave();
  game.view = "optimum";
  showActions();
  begin(game.seed);
  if (wasOn) keepRun("");
  else learning.enter();
}

function byHand(action, keys) {
  watch(false);
  choose(action, keys);
}

function restart(seed) {
  watch(false);
  begin(seed);
}

const MOVES = ["stay", ...SIDES.slice(1)];
const TURNS = ["left", "right", "forward"];
const CONTROLS = {
  ...Object.fromEntries(
    [MOVES, TURNS].flatMap((names) => names.map((name, action) => [name, (keys) => byHand(action, keys)])),
  ),
  undo,
  hint,
  retry: () => restart(game.seed),
  "new-luck": () => restart(seedAfter(game.seed, game.nextSeed)),
  watch: () => byId("watch").hidden || watch(!isWatching),
  values: () => toggle("values"),
  policy: () => toggle("policy"),
  belief: () => toggle("belief"),
  turning: turn,
  learn,
  look: () => byId("look").hidden || lookAround(),
  download: () => downloadPlays(game),
  stop: () => watch(false),
  onwards: () => /** @type {any} */ (document.querySelector(".onwards:not([hidden])"))?.click(),
  fit: () => view.fit(),
  larger: () => view.zoomTo(view.zoom * ZOOM_STEP),
  smaller: () => view.zoomTo(view.zoom / ZOOM_STEP),
};

const MOVE_KEYS = ["arrowup", "arrowright", "arrowdown", "arrowleft", ..."9317"];
/** What keys do, and those that buttons show. */
const KEYS = {
  ...Object.fromEntries(MOVE_KEYS.map((key, at) => [key, SIDES[at + 1]])),
  ...{ w: "north", d: "east", s: "south", a: "west", " ": "stay" },
  ...{ escape: "stop", enter: "onwards", 0: "fit", "+": "larger", "=": "larger", "-": "smaller" },
};
for (const key of document.querySelectorAll("[data-control] > kbd"))
  KEYS[key.textContent.toLowerCase()] = key.parentElement.dataset.control;

/** What the keys and swipes of moves do while the robot turns; the others do nothing. */
const TURN_KEYS = { north: "forward", east: "right", west: "left" };

function move(name, keys) {
  if (MOVES.indexOf(name) >= game.actions) return;
  CONTROLS[game.isTurning ? TURN_KEYS[name] : name]?.(keys);
}

document.addEventListener("keydown", (event) => {
  if (game === null || event.ctrlKey || event.metaKey || event.altKey) return;
  if (view.stage.closest("[hidden]") !== null) return;
  const { target } = event;
  if (target.matches("[type=text]")) return;
  if (target.matches("[type=radio]") && /^Arrow| /.test(event.key)) return;
  if (/^( |Enter)$/.test(event.key) && target.matches("a, button, input, summary")) return;
  if (event.key.length === 1 && !byId("shortcuts").checked) return;
  if (learning.isOn && learning.press(event)) return;
  const control = KEYS[event.key.toLowerCase()];
  if (control === undefined) return;
  event.preventDefault();
  const isMove = MOVES.includes(control);
  // A key that is held down waits until the robot has arrived.
  if (event.repeat && (picture.running !== null || !isMove || control === "stay")) return;
  // Of two robots, letters move the first, arrows the second; the space bar is everybody's.
  if (isMove) move(control, control === "stay" ? undefined : Number(event.key.length > 1));
  else CONTROLS[control]();
});
const isPlayed = () => game !== null && !learning.isOn;
listenToGestures(
  view,
  (side) => isPlayed() && move(SIDES[side]),
  (event) => isPlayed() && walkTo(event),
);
SIDES.slice(5).forEach((name, at) => {
  const data = { "data-control": name, "data-action": at + 5, "aria-label": capital(name) };
  const button = html("button", { class: "diagonal", ...data }, "↗↘↙↖"[at]);
  button.style.gridArea = ["1/3", "3/3", "3/1", "1/1"][at];
  document.querySelector(".pad").append(button);
});
for (const button of document.querySelectorAll("[data-control]")) {
  button.addEventListener("click", () => CONTROLS[button.dataset.control]());
}
byId("seed").addEventListener("change", ({ target }) => {
  if (!target.checkValidity() || target.value === "") return;
  if (learning.isOn) learning.begin(target.value);
  else restart(target.value);
});
if (matchMedia("(min-width: 64rem) and (min-height: 45rem)").matches) byId("message").after(byId("learn-charts"));
recallName();
offerSounds();
byId("who").addEventListener("change", keepName);
// Whoever points at a set plays next: its keys are not those of a choice.
byId("sets").addEventListener("click", ({ detail }) => detail > 0 && view.stage.focus({ preventScroll: true }));
byId("trail").addEventListener("change", showTrail);
