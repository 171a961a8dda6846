// The page: shows and plays its own level, or the one that stands behind the `#` of its address.
const find = (id) => document.getElementById(id);
const OWN = JSON.parse(find("data").textContent);
const HELLO = "Walk the robot to the exit.";

let game = null;
let picture = null;
let isWatching = false;
let timer = null;

/** Show a level, and begin to play it. Nothing changes if it cannot be. */
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
    data.walker === "best" ? "Watch the best policy" : "Watch a random walk";
  for (const name of ["values", "policy"]) {
    find(`show-${name}`).hidden = data.policy === null;
    find(`show-${name}`).setAttribute("aria-pressed", data.shown.includes(name));
  }
  find("seed").value = data.seed;
  picture.stand(game.state);
  show(HELLO);
}

function factElements([name, told]) {
  const [term, detail, text] = ["dt", "dd", "bdi"].map((tag) => document.createElement(tag));
  term.textContent = name;
  text.textContent = told;
  detail.append(text);
  return [term, detail];
}

/** Show the level of the address; if something is wrong with that, say so and show one's own. */
async function showAddressed() {
  const { hash } = location;
  let fault = "";
  try {
    const linked = await linkedLevel(hash);
    if (hash !== location.hash) return; // Another level is on its way.
    showLevel(linked ?? checked(OWN));
  } catch (error) {
    if (hash !== location.hash) return;
    fault = error instanceof LinkFault ? error.message : NOT_A_LEVEL;
    showLevel(OWN);
  }
  notify(fault && `${fault} Shown here is the page's own level.`);
  document.body.classList.add("ready");
}

/** Say what is wrong; commands stand between backticks. */
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
  find("return").textContent = told(game.total);
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
  walk();
}

function walk() {
  if (!isWatching) return;
  const action = game.end === null ? game.advice() : -1;
  if (action < 0) watch(false);
  else take(action);
}

function take(action) {
  if (game.end !== null) {
    show(`${game.ending()} Restart to play again.`, game.end);
    return;
  }
  const step = game.step(action);
  const isEnd = game.end !== null;
  show(isEnd ? `${game.story(step)}. ${game.ending()}` : game.story(step),
    isEnd ? game.end : step.event);
  picture.go(step, () => {
    if (isWatching) timer = setTimeout(walk, picture.calm.matches ? 400 : 90);
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
  // A key that is held waits until the robot is there.
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
