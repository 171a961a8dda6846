// The trail: the way that the robot came, and the arrow of a hint.

import { COMMON } from "./common.js";
import { element } from "./paint.js";

const LONGEST_TRAIL = 2000; // Steps.

/** The layers of a picture below and above the robot that belong to an episode. */
export class Trail {
  constructor(game, svg) {
    this.game = game;
    const width = 0.06 * COMMON.cell;
    const line = (color, dash) =>
      element("path", {
        fill: "none",
        stroke: color,
        opacity: 0.5,
        "stroke-width": width,
        "stroke-linecap": "round",
        "stroke-dasharray": dash,
      });
    /** The lines of each robot, and its dots. */
    this.lines = game.colors.map((color) => [line(color), line(color, `0 ${2 * width}`)]);
    this.group = element("g", { id: "walked" }, ...this.lines.flat());
    this.arrow = element("g", { id: "hinted" });
    const robot = svg.querySelector("#robot");
    robot.before(this.group);
    robot.after(this.arrow);
  }

  /** Show the way to the state at hand: lines between neighbours, dots where the robot jumped. */
  stand() {
    const { past, state } = this.game;
    const states = [...past.slice(-LONGEST_TRAIL).map((before) => before.state), state];
    const ways = states.map((each) => this.game.places(each));
    this.lines.forEach((lines, robot) => {
      const paths = ["", ""];
      for (let at = 1; at < ways.length; at++) {
        const [from, to] = [ways[at - 1][robot], ways[at][robot]];
        const [dx, dy] = [to[0] - from[0], to[1] - from[1]].map(Math.abs);
        if (dx + dy > 0) paths[Number(dx > 1 || dy > 1)] += `M${this.middle(from)}L${this.middle(to)}`;
      }
      lines.forEach((line, kind) => line.setAttribute("d", paths[kind]));
    });
  }

  middle([x, y]) {
    return this.game.corner(x + 0.5, y + 0.5);
  }

  /** Show an action as arrows over robots; a negative one shows what is chosen so far. */
  point(action) {
    const size = COMMON.cell / 24;
    const arrows = this.game.pointers(action).map(({ place, side }) => {
      const [x, y] = this.middle(place);
      return element("path", {
        d: side < 0 ? "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z" : "M0 -21l8 9h-4.5v6h-7v-6h-4.5z",
        transform: `translate(${x} ${y}) rotate(${90 * Math.max(side, 0)}) scale(${size})`,
        fill: "#ffd60a",
        stroke: "#1b1b1b",
        "stroke-width": 1.2,
      });
    });
    this.arrow.replaceChildren(...arrows);
  }
}
