// The first minute: what one does with an empty level, as three steps.

import { pairControl } from "./controls.js";
import { growMaze } from "./maze.js";

/** The three steps, with the controls that begin them. */
export class Greeting {
  constructor(editor, element) {
    this.editor = editor;
    this.element = element;
    this.size = pairControl({ type: "size", label: "size" }, (size) => editor.send({ do: "resize", size }));
    const [first, , last] = element.children;
    this.last = last;
    const grow = first.querySelector(".grow");
    grow.before(this.size.element);
    grow.onclick = () => growMaze(editor);
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
