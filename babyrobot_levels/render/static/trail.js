// The trail: the way that the robot came, and the arrow of a hint.

import { COMMON } from "./common.js";
import { FORWARD } from "./game.js";
import { element } from "./paint.js";

const LONGEST_TRAIL = 2000; // Steps.

/** The layers of a picture below and above the robot that belong to an episode. */
export class Trail {
  constructor(game, svg) {
    this.game = game;
    const [color] = game.data.robot;
    const width = 0.06 * COMMON.cell;
    const line = (dash) =>
      element("path", {
        fill: "none",
        stroke: color,
        opacity: 0.5,
        "stroke-width": width,
        "stroke-linecap": "round",
        "stroke-dasharray": dash,
      });
    this.walked = line();
    this.jumped = line(`0 ${2 * width}`);
    this.group = element("g", { id: "walked" }, this.walked, this.jumped);
    this.arrow = element("g", { id: "hinted" });
    const robot = svg.querySelector("#robot");
    robot.before(this.group);
    robot.after(this.arrow);
  }

  /** Show the way to the state at hand: lines between neighbours, dots where the robot jumped. */
  stand() {
    const { past, state } = this.game;
    const states = [...past.slice(-LONGEST_TRAIL).map((before) => before.state), state];
    const paths = ["", ""];
    for (let at = 1; at < states.length; at++) {
      const [from, to] = [states[at - 1], states[at]].map((each) => this.game.place(each));
      const [dx, dy] = [to[0] - from[0], to[1] - from[1]].map(Math.abs);
      if (dx + dy > 0) paths[Number(dx > 1 || dy > 1)] += `M${this.middle(from)}L${this.middle(to)}`;
    }
    this.walked.setAttribute("d", paths[0]);
    this.jumped.setAttribute("d", paths[1]);
  }

  middle([x, y]) {
    return this.game.corner(x + 0.5, y + 0.5);
  }

  /** Show an action as an arrow over the robot; a negative one shows none. */
  point(action) {
    this.arrow.replaceChildren();
    if (action < 0) return;
    const { state, isTurning, heading } = this.game;
    const [x, y] = this.middle(this.game.place(state));
    const side = isTurning ? (action === FORWARD ? heading : heading + 3 + 2 * action) % 4 : action - 1;
    const size = COMMON.cell / 24;
    const shape =
      action === 0 && !isTurning ? "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z" : "M0 -21l8 9h-4.5v6h-7v-6h-4.5z";
    this.arrow.append(
      element("path", {
        d: shape,
        transform: `translate(${x} ${y}) rotate(${90 * Math.max(side, 0)}) scale(${size})`,
        fill: "#ffd60a",
        stroke: "#1b1b1b",
        "stroke-width": 1.2,
      }),
    );
  }
}
