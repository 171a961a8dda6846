// The simulation: one robot in one level, and what happens in words.
const COMMON = JSON.parse(document.getElementById("common").textContent);
const SIDES = ["", "north", "east", "south", "west"];
const OUTCOME_LENGTH = 6;

/** One robot in one level, without a picture. */
class Game {
  constructor(data) {
    this.data = data;
    this.seed(data.seed);
  }

  /** Start the first episode of a seed. */
  seed(seed) {
    this.random = new Generator(seed);
    this.policyRandom = new Generator(seed);
    this.reset();
  }

  /** Start the next episode. */
  reset() {
    const { starts } = this.data;
    this.state = starts[this.random.integer(starts.length)];
    this.steps = 0;
    this.total = 0;
    this.end = null;
  }

  isPossible(action) {
    return ((this.data.possible[this.state] >> action) & 1) === 1;
  }

  /** Return the action of the watched policy here; -1 if it has none. */
  advice() {
    const { walker, policy } = this.data;
    if (walker === "best") return policy[this.state];
    const possible = [0, 1, 2, 3, 4].filter((action) => this.isPossible(action));
    return possible[this.policyRandom.integer(possible.length)];
  }

  /** Take an action and return the outcome. */
  step(action) {
    const from = this.state;
    const { rows, table, exits, max_steps: most } = this.data;
    const outcomes = rows[table[5 * from + action]];
    const last = outcomes.length - OUTCOME_LENGTH;
    let at = 0;
    if (last > 0) {
      const draw = this.random.random();
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

  /** Describe the outcome of a step. */
  describeStep({ from, action, next, reward, event }) {
    const place = `[${this.place(next).join(", ")}]`;
    const side = SIDES[action];
    const words = {
      stay: "Stayed",
      move: `Moved ${side} to ${place}`,
      carried: `Carried to ${place}`,
      bump: `Blocked by a wall to the ${side}`,
      skid: from === next ? `Skidded while moving ${side}, and stayed` :
        `Skidded to ${place} while moving ${side}`,
      bounce: from === next ? "Bounced off the glass" : `Bounced off the glass to ${place}`,
    };
    return `${words[event]}: ${reward > 0 ? "+" : ""}${formatted(reward)}`;
  }

  /** Describe how the episode ended. */
  describeEnd() {
    const after = `after ${this.steps} step${this.steps === 1 ? "" : "s"}`;
    const how = {
      exit: `Exit reached ${after}!`,
      over: `The episode ended ${after}.`,
      time: `Time limit reached ${after}.`,
    };
    return `${how[this.end]} Return ${formatted(this.total)}.`;
  }
}

/** Return a number with at most two decimals and a minus sign. */
function formatted(number) {
  return String(Math.round(number * 100) / 100 + 0).replace("-", "\u2212");
}
