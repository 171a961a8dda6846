// The page: shows and plays its own level, or the one after the `#` of its address.
const find = (id) => document.getElementById(id);
const OWN = JSON.parse(find("data").textContent);
const HELLO = "Move the robot to an exit.";

let game = null;
let picture = null;
let isWatching = false;
let timer = null;

/** Show a level and start to play it; nothing changes if that fails. */
function showLevel(data) {
  const svg = levelPicture(data);
  watch(false);
  picture?.stop();
  game = new Game(data, data.turns?.on ?? false);
  picture = new Picture(game, svg, find("stage"));
  document.title = data.title;
  for (const name of ["title", "description"]) find(name).textContent = data[name];
  find("facts").replaceChildren(...data.facts.flatMap(factElements));
  find("watched").textContent =
    data.walker === "best" ? "Watch the optimal policy" : "Watch the random policy";
  for (const name of ["values", "policy"]) {
    find(`show-${name}`).setAttribute("aria-pressed", data.shown.includes(name));
  }
  find("seed").value = data.seed;
  find("turning").hidden = data.turns === undefined;
  showActions();
  picture.stand();
  show(HELLO + game.things.needs(game.configuration));
}

/** Show the controls of the robot's actions, and what is known about them. */
function showActions() {
  const { data, isTurning } = game;
  const known = isTurning ? data.turns : data;
  find("turning").setAttribute("aria-pressed", isTurning);
  for (const place of document.querySelectorAll("[data-mode]")) {
    place.hidden = (place.dataset.mode === "turns") !== isTurning;
  }
  const { walker } = data;
  find("watch").hidden = walker === null || (walker === "best" && known.policy === null);
  find("best").textContent = known.best;
  find("best").parentElement.hidden = known.best === "";
  find("show-values").hidden = known.policy === null;
  find("show-policy").hidden = known.policy === null || isTurning;
}

function factElements([name, value]) {
  const [term, detail, text] = ["dt", "dd", "bdi"].map((tag) => document.createElement(tag));
  term.textContent = name;
  text.textContent = value;
  detail.append(text);
  return [term, detail];
}

/** Show the level of the address, or the page's own level if there is none or it is invalid. */
async function showAddressed() {
  const { hash } = location;
  let message = "";
  try {
    const linked = await linkedLevel(hash);
    if (hash !== location.hash) return; // Another level is being loaded.
    showLevel(linked ?? checked(OWN));
  } catch (error) {
    if (hash !== location.hash) return;
    message = error instanceof LinkError ? error.message : NOT_A_LEVEL;
    showLevel(OWN);
  }
  notify(message && `${message} The page shows its own level instead.`);
  document.body.classList.add("ready");
}

/** Show an error message; commands in it are between backticks. */
function notify(message) {
  const parts = message.split("`").map((part, index) => {
    const element = document.createElement(index % 2 ? "code" : "span");
    element.textContent = part;
    return element;
  });
  find("notice").replaceChildren(...parts);
  find("notice").hidden = message === "";
}

function show(message, kind = "") {
  find("steps").textContent = game.steps;
  find("return").textContent = formatted(game.total);
  const line = find("message");
  line.textContent = message;
  line.dataset.kind = kind;
  showHeld();
  for (const button of document.querySelectorAll("[data-action]")) {
    if (button.parentElement.hidden) continue;
    const isOpen = game.end === null && game.isPossible(Number(button.dataset.action));
    button.classList.toggle("shut", !isOpen);
  }
}

/** Show what is held, and which switches are on. */
function showHeld() {
  const { things, configuration } = game;
  const groups = [["Held", "item", things.held(configuration)],
    ["On", "switch", things.on(configuration)]];
  find("held").replaceChildren(...groups.flatMap(([title, kind, found]) =>
    (things.of(kind).length === 0 ? [] : [heldElement(title, found)])));
  find("held").hidden = !find("held").hasChildNodes();
}

function heldElement(title, found) {
  const [group, name] = ["div", "dt"].map((tag) => document.createElement(tag));
  name.textContent = title;
  group.append(name, ...(found.length === 0 ? [null] : found).map((thing) => {
    const detail = document.createElement("dd");
    if (thing === null) {
      detail.textContent = "nothing";
      detail.className = "none";
      return detail;
    }
    const [look, left, top, side] = thing.icon;
    const box = [left, top, side, side].map(pixels).join(" ");
    const icon = element("svg", { viewBox: box, "aria-hidden": true }, lookElement(look));
    detail.append(icon, thing.name);
    return detail;
  }));
  return group;
}

function watch(wanted) {
  isWatching = wanted;
  clearTimeout(timer);
  find("watch").setAttribute("aria-pressed", wanted);
  if (!wanted) return;
  if (game.end !== null) begin();
  takeAdvice();
}

function takeAdvice() {
  if (!isWatching) return;
  const action = game.end === null ? game.advice() : -1;
  if (action < 0) watch(false);
  else take(action);
}

function take(action) {
  if (game.end !== null) {
    show(`${game.describeEnd()} Restart to play again.`, game.end);
    return;
  }
  const step = game.step(action);
  const isEnd = game.end !== null;
  show(isEnd ? `${game.describeStep(step)}. ${game.describeEnd()}` : game.describeStep(step),
    isEnd ? game.end : step.event);
  picture.go(step, () => {
    if (isWatching) timer = setTimeout(takeAdvice, picture.calm.matches ? 400 : 90);
  });
}

function begin(seed = null) {
  if (seed === null) game.reset();
  else game.seed(seed);
  picture.stand();
  show("A new episode begins.");
}

function toggle(name) {
  const button = find(`show-${name}`);
  if (button.hidden) return;
  const isShown = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", isShown);
  for (const layer of name === "values" ? ["heat", name] : [name]) {
    find(layer).classList.toggle("hidden", !isShown);
  }
  picture.marks.stand();
}

/** Let the robot turn, or move to all sides again: from the first episode of the seed. */
function turn() {
  if (find("turning").hidden) return;
  watch(false);
  game.isTurning = !game.isTurning;
  showActions();
  begin(find("seed").checkValidity() ? find("seed").value : game.data.seed);
}

function byHand(action) {
  if (isWatching) watch(false);
  take(action);
}

const MOVES = ["stay", ...SIDES.slice(1)];
const TURNS = ["left", "right", "forward"];
const CONTROLS = {
  ...Object.fromEntries([MOVES, TURNS].flatMap((names) =>
    names.map((name, action) => [name, () => byHand(action)]))),
  restart: () => {
    watch(false);
    begin();
  },
  watch: () => find("watch").hidden || watch(!isWatching),
  values: () => toggle("values"),
  policy: () => toggle("policy"),
  turning: turn,
};

const KEYS = {
  arrowup: "north", arrowright: "east", arrowdown: "south", arrowleft: "west",
  w: "north", d: "east", s: "south", a: "west", " ": "stay",
  r: "restart", p: "watch", v: "values", b: "policy", t: "turning",
};

/** What the keys of moves do while the robot turns; the others do nothing. */
const TURN_KEYS = { north: "forward", east: "right", west: "left" };

document.addEventListener("keydown", (event) => {
  if (game === null || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.matches("input") || (event.key === " " && event.target.matches("button"))) {
    return;
  }
  const control = KEYS[event.key.toLowerCase()];
  if (control === undefined) return;
  event.preventDefault();
  const isMove = MOVES.includes(control);
  // A key that is held down waits until the robot has arrived.
  if (event.repeat && (picture.running !== null || !isMove || control === "stay")) return;
  CONTROLS[isMove && game.isTurning ? TURN_KEYS[control] : control]?.();
});
for (const button of document.querySelectorAll("[data-control]")) {
  button.addEventListener("click", () => CONTROLS[button.dataset.control]());
}
find("seed").addEventListener("change", ({ target }) => {
  if (!target.checkValidity() || target.value === "") return;
  watch(false);
  begin(target.value);
});
addEventListener("hashchange", showAddressed);
showAddressed();
