// The rules: one robot in one level, and how people are told what happens.
const COMMON = JSON.parse(document.getElementById("common").textContent);
const SIDES = ["", "north", "east", "south", "west"];
const OUTCOME_LENGTH = 6;

/** One robot in one level, without a picture. */
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

  /** Return what the walker does here; -1 where it has no advice. */
  advice() {
    const { walker, policy } = this.data;
    if (walker === "best") return policy[this.state];
    const possible = [0, 1, 2, 3, 4].filter((action) => this.isPossible(action));
    return possible[this.whim.integer(possible.length)];
  }

  /** Take an action and return what came of it. */
  step(action) {
    const from = this.state;
    const { rows, table, exits, max_steps: most } = this.data;
    const outcomes = rows[table[5 * from + action]];
    const last = outcomes.length - OUTCOME_LENGTH;
    let at = 0;
    if (last > 0) {
      const draw = this.chance.random();
      for (let sum = outcomes[0]; at < last && draw >= sum; sum += outcomes[at]) {
        at += OUTCOME_LENGTH;
      }
    }
    const [, shift, reward, isOver, event, pose] = outcomes.slice(at, at + OUTCOME_LENGTH);
    const next = from + shift;
    this.state = next;
    this.steps += 1;
    this.total += reward;
    if (isOver) this.end = exits.includes(next) ? "exit" : "over";
    else if (this.steps === most) this.end = "time";
    const after = this.end === "exit" ? COMMON.cheer : pose;
    return { from, action, next, reward, event: COMMON.events[event], pose, after };
  }

  place(state) {
    return [state % this.data.width, Math.floor(state / this.data.width)];
  }

  /** Say in words what came of a step. */
  story({ from, action, next, reward, event }) {
    const place = `[${this.place(next).join(", ")}]`;
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

  /** Tell how the episode ended. */
  ending() {
    const after = `after ${this.steps} step${this.steps === 1 ? "" : "s"}`;
    const how = {
      exit: `At the exit ${after}!`,
      over: `The episode ended ${after}.`,
      time: `Time is up ${after}.`,
    };
    return `${how[this.end]} Return ${told(this.total)}.`;
  }
}

/** Write a number as people do: two decimals at most, and a true minus. */
function told(number) {
  return String(Math.round(number * 100) / 100 + 0).replace("-", "\u2212");
}
