// The first minute: what one does with an empty level, as three steps.

import { html } from "../../../render/static/dom.js";
import { pairControl } from "./controls.js";
import { button } from "./html.js";
import { growMaze } from "./maze.js";

/** The three steps, with the controls that begin them. */
export class Greeting {
  constructor(editor) {
    this.editor = editor;
    this.size = pairControl({ type: "size", label: "size" }, (size) => editor.send({ do: "resize", size }));
    this.last = html("li", {});
    this.element = html(
      "ol",
      { class: "steps" },
      html(
        "li",
        {},
        "Set the size, or grow a maze.",
        html(
          "span",
          { class: "buttons" },
          this.size.element,
          button("Grow a maze", { onclick: () => growMaze(editor) }),
        ),
      ),
      html("li", {}, "Draw walls and things with the tools. Drag start and exit where they shall be."),
      this.last,
    );
  }

  /** Whether there is nothing in the level but where it begins and ends. */
  get isDue() {
    const { is_valid, level, places, fields } = this.editor.state;
    return (
      is_valid && level !== null && !fields.maze && places.every(({ kind }) => kind === "start" || kind === "exit")
    );
  }

  show() {
    const { level, lacks } = this.editor.state;
    const { width, height } = level;
    this.last.textContent =
      lacks === "" ? "Play it, then save it: both are at the top." : "Save it, or copy its link: both are at the top.";
    this.size.show([width, height]);
  }
}
