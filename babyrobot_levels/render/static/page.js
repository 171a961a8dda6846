// Plays a level. Everything that it knows of the level is one object: the compiled tables, and
// how the robot looks after each outcome.
const FORMAT = "babyrobot-page";
const VERSION = 1;
const SIDES = ["", "north", "east", "south", "west"];
const SHIFTS = [[0, 0], [0, -1], [1, 0], [0, 1], [-1, 0]];
const OUTCOME_LENGTH = 6;
const GLIDE = 220; // Milliseconds from cell to cell, at the usual speed.
const CELLS = [22, 112]; // The smallest and the largest cells, in pixels.

/** One robot in one level: the rules, without a picture. */
class Game {
  constructor(data) {
    this.data = data;
    this.seed(data.seed);
  }

  /** Begin the first episode of a seed. */
  seed(seed) {
    this.chance = new Generator(seed);
    this.whim = new Generator(seed);
    this.reset();
  }

  /** Begin the next episode. */
  reset() {
    const { starts } = this.data;
    this.state = starts[this.chance.integer(starts.length)];
    this.steps = 0;
    this.total = 0;
    this.end = null;
  }

  isPossible(action) {
    return ((this.data.possible[this.state] >> action) & 1) === 1;
  }

  /** Return what the walker does here; null where it has no advice. */
  advice() {
    const { walker, policy } = this.data;
    if (walker === "best") return policy[this.state];
    const possible = [0, 1, 2, 3, 4].filter((action) => this.isPossible(action));
    return possible[this.whim.integer(possible.length)];
  }

  /** Take an action and return what came of it. */
  step(action) {
    const from = this.state;
    const outcomes = this.data.outcomes[from][action];
    const last = outcomes.length - OUTCOME_LENGTH;
    let at = 0;
    if (last > 0) {
      const draw = this.chance.random();
      for (let sum = outcomes[0]; at < last && draw >= sum; sum += outcomes[at]) {
        at += OUTCOME_LENGTH;
      }
    }
    const [, next, reward, isOver, event, pose] = outcomes.slice(at, at + OUTCOME_LENGTH);
    this.state = next;
    this.steps += 1;
    this.total += reward;
    if (isOver) this.end = this.data.exits.includes(next) ? "exit" : "over";
    else if (this.steps === this.data.max_steps) this.end = "time";
    const after = this.end === "exit" ? this.data.cheer : pose;
    return { from, action, next, reward, event: this.data.events[event], pose, after };
  }
}

/** The picture: where the robot is, and how he gets there. */
class Picture {
  constructor(data, stage) {
    this.data = data;
    this.stage = stage;
    this.robot = stage.querySelector("#robot");
    this.sprite = this.robot.querySelector("use");
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.running = null;
    this.fit(stage.querySelector("svg"));
  }

  /** Make the picture as large as there is room, in reason; a larger one is scrolled. */
  fit(svg) {
    const { width, height } = svg.viewBox.baseVal;
    const [least, most] = CELLS.map((pixels) => (pixels * width) / this.data.cell);
    const room = `min(100%, max(50vh, 100vh - 17rem) * ${(width / height).toFixed(3)})`;
    svg.style.width = `clamp(${least.toFixed(0)}px, ${room}, ${most.toFixed(0)}px)`;
  }

  place(state) {
    return [state % this.data.width, Math.floor(state / this.data.width)];
  }

  /** Show the robot at a place, in a pose, so far between two places. */
  draw([x, y], pose, phase = 0) {
    const { cell, margin, phases } = this.data;
    const left = margin + x * cell;
    const top = margin + y * cell;
    this.robot.setAttribute("transform", `translate(${left.toFixed(2)} ${top.toFixed(2)})`);
    this.sprite.setAttribute("href", `#pose-${pose}-${Math.round(phase * phases) % phases}`);
  }

  stand(state, pose = 0) {
    this.stop();
    this.robot.dataset.state = state;
    this.draw(this.place(state), pose);
    this.follow();
  }

  stop() {
    cancelAnimationFrame(this.running);
    this.running = null;
  }

  /** Let the robot go where a step led, and call `then` when he is there. */
  go({ from, action, next, event, pose, after }, then) {
    const start = this.place(from);
    const end = this.place(next);
    const shift = [end[0] - start[0], end[1] - start[1]];
    const duration = this.calm.matches ? 0 : GLIDE / this.data.speed;
    const toWall = event === "bump" || (event === "bounce" && from === next);
    this.stop();
    this.robot.dataset.state = next;
    let begin = null;
    const frame = (now) => {
      begin ??= now;
      const phase = duration ? Math.min(1, (now - begin) / duration) : 1;
      const eased = phase * phase * (3 - 2 * phase);
      const reach = toWall ? 0.13 * Math.sin(Math.PI * phase) : eased;
      const [dx, dy] = toWall ? SHIFTS[action] : shift;
      const isThere = phase === 1;
      const place = isThere ? end : [start[0] + reach * dx, start[1] + reach * dy];
      this.draw(place, isThere ? after : pose, isThere || from === next ? 0 : phase);
      this.running = isThere ? null : requestAnimationFrame(frame);
      if (isThere) {
        this.follow();
        then();
      }
    };
    this.running = requestAnimationFrame(frame);
  }

  /** Scroll so that the robot is seen: large levels do not fit. */
  follow() {
    const frame = this.stage.getBoundingClientRect();
    const robot = this.robot.getBoundingClientRect();
    const margin = 1.5 * robot.width;
    const isSeen = robot.left > frame.left + margin && robot.right < frame.right - margin &&
      robot.top > frame.top + margin && robot.bottom < frame.bottom - margin;
    if (isSeen) return;
    this.stage.scrollTo({
      left: this.stage.scrollLeft + robot.left - frame.left - (frame.width - robot.width) / 2,
      top: this.stage.scrollTop + robot.top - frame.top - (frame.height - robot.height) / 2,
      behavior: this.calm.matches ? "auto" : "smooth",
    });
  }
}

/** Write a number as people do: two decimals at most, and a true minus. */
function told(number) {
  return String(Math.round(number * 100) / 100 + 0).replace("-", "\u2212");
}

/** Say in words what came of a step. */
function story({ from, action, next, reward, event }, picture) {
  const place = `[${picture.place(next).join(", ")}]`;
  const side = SIDES[action];
  const words = {
    stay: "Stayed",
    move: `Moved ${side} to ${place}`,
    carried: `Carried to ${place}`,
    bump: `There is a wall to the ${side}`,
    skid: from === next ? `Skidded and stayed, on the way ${side}` :
      `Skidded to ${place}, on the way ${side}`,
    bounce: from === next ? "The glass held" : `The glass held, and bounced him to ${place}`,
  };
  return `${words[event]}: ${reward > 0 ? "+" : ""}${told(reward)}`;
}

/** Tell how an episode ended. */
function ending(game) {
  const after = `after ${game.steps} step${game.steps === 1 ? "" : "s"}`;
  const how = {
    exit: `At the exit ${after}!`,
    over: `The episode ended ${after}.`,
    time: `Time is up ${after}.`,
  };
  return `${how[game.end]} Return ${told(game.total)}.`;
}

function start(data) {
  if (data.format !== FORMAT || data.version !== VERSION) throw new Error("unknown data");
  const find = (id) => document.getElementById(id);
  const game = new Game(data);
  const picture = new Picture(data, find("stage"));
  let isWatching = false;
  let timer = null;

  const show = (message, kind = "") => {
    find("steps").textContent = game.steps;
    find("return").textContent = told(game.total);
    const line = find("message");
    line.textContent = message;
    line.dataset.kind = kind;
    for (const button of document.querySelectorAll("[data-action]")) {
      const isOpen = game.end === null && game.isPossible(Number(button.dataset.action));
      button.classList.toggle("shut", !isOpen);
    }
  };

  const watch = (wanted) => {
    isWatching = wanted;
    clearTimeout(timer);
    find("watch")?.setAttribute("aria-pressed", wanted);
    if (!wanted) return;
    if (game.end !== null) begin();
    walk();
  };

  const walk = () => {
    if (!isWatching) return;
    if (game.end !== null) watch(false);
    else take(game.advice());
  };

  const take = (action) => {
    if (game.end !== null) {
      show(`${ending(game)} Restart to play again.`, game.end);
      return;
    }
    const step = game.step(action);
    const isEnd = game.end !== null;
    show(isEnd ? `${story(step, picture)}. ${ending(game)}` : story(step, picture),
      isEnd ? game.end : step.event);
    picture.go(step, () => {
      if (isWatching) timer = setTimeout(walk, picture.calm.matches ? 400 : 90);
    });
  };

  const begin = (seed = null) => {
    if (seed === null) game.reset();
    else game.seed(seed);
    picture.stand(game.state);
    show("A new episode begins.");
  };

  const toggle = (id) => {
    const button = find(`show-${id}`);
    if (button === null) return;
    const isShown = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", isShown);
    find(id).classList.toggle("hidden", !isShown);
  };

  const controls = {
    stay: () => byHand(0),
    north: () => byHand(1),
    east: () => byHand(2),
    south: () => byHand(3),
    west: () => byHand(4),
    restart: () => {
      watch(false);
      begin();
    },
    watch: () => find("watch") && watch(!isWatching),
    values: () => toggle("values"),
    policy: () => toggle("policy"),
  };
  const byHand = (action) => {
    if (isWatching) watch(false);
    take(action);
  };

  const keys = {
    arrowup: "north", arrowright: "east", arrowdown: "south", arrowleft: "west",
    w: "north", d: "east", s: "south", a: "west", " ": "stay",
    r: "restart", p: "watch", v: "values", b: "policy",
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.matches("input") || (event.key === " " && event.target.matches("button"))) {
      return;
    }
    const control = keys[event.key.toLowerCase()];
    if (control === undefined) return;
    event.preventDefault();
    // A key that is held waits until the robot is there.
    if (event.repeat && (picture.running !== null || !SIDES.includes(control))) return;
    controls[control]();
  });
  for (const button of document.querySelectorAll("[data-control]")) {
    button.addEventListener("click", () => controls[button.dataset.control]());
  }
  find("seed").addEventListener("change", ({ target }) => {
    if (!target.checkValidity() || target.value === "") return;
    watch(false);
    begin(target.value);
  });

  find("seed").value = data.seed;
  picture.stand(game.state);
  show(find("message").textContent);
  document.body.classList.add("ready");
}

start(JSON.parse(document.getElementById("data").textContent));
