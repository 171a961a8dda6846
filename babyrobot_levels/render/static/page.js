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
  game = new Game(data);
  picture = new Picture(game, svg, find("stage"));
  document.title = data.title;
  for (const name of ["title", "description", "best"]) find(name).textContent = data[name];
  find("facts").replaceChildren(...data.facts.flatMap(factElements));
  find("best").parentElement.hidden = data.best === "";
  find("watch").hidden = data.walker === null;
  find("watched").textContent =
    data.walker === "best" ? "Watch the optimal policy" : "Watch the random policy";
  for (const name of ["values", "policy"]) {
    find(`show-${name}`).hidden = data.policy === null;
    find(`show-${name}`).setAttribute("aria-pressed", data.shown.includes(name));
  }
  find("seed").value = data.seed;
  picture.stand(game.state);
  show(HELLO);
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
  for (const button of document.querySelectorAll("[data-action]")) {
    const isOpen = game.end === null && game.isPossible(Number(button.dataset.action));
    button.classList.toggle("shut", !isOpen);
  }
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
  picture.stand(game.state);
  show("A new episode begins.");
}

function toggle(name) {
  const button = find(`show-${name}`);
  if (button.hidden) return;
  const isShown = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", isShown);
  find(name).classList.toggle("hidden", !isShown);
}

function byHand(action) {
  if (isWatching) watch(false);
  take(action);
}

const CONTROLS = {
  stay: () => byHand(0),
  north: () => byHand(1),
  east: () => byHand(2),
  south: () => byHand(3),
  west: () => byHand(4),
  restart: () => {
    watch(false);
    begin();
  },
  watch: () => find("watch").hidden || watch(!isWatching),
  values: () => toggle("values"),
  policy: () => toggle("policy"),
};

const KEYS = {
  arrowup: "north", arrowright: "east", arrowdown: "south", arrowleft: "west",
  w: "north", d: "east", s: "south", a: "west", " ": "stay",
  r: "restart", p: "watch", v: "values", b: "policy",
};

document.addEventListener("keydown", (event) => {
  if (game === null || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.matches("input") || (event.key === " " && event.target.matches("button"))) {
    return;
  }
  const control = KEYS[event.key.toLowerCase()];
  if (control === undefined) return;
  event.preventDefault();
  // A key that is held down waits until the robot has arrived.
  if (event.repeat && (picture.running !== null || !SIDES.includes(control))) return;
  CONTROLS[control]();
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
