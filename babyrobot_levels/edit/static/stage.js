// The stage: the picture of the level, and which cell or side a point of the window is at.

class Stage {
  constructor(editor, place) {
    this.editor = editor;
    this.place = place;
    editor.on("state", () => this.show());
    place.addEventListener("pointerdown", (event) => {
      const { cell } = this.spotAt(event);
      if (cell !== null) editor.send({ do: "paint", brush: "small", cells: [cell] });
    });
  }

  show() {
    const { level } = this.editor.state;
    this.place.classList.toggle("dimmed", !this.editor.state.is_valid);
    if (level === null) return;
    this.game = new Game(level);
    this.svg = levelPicture(level);
    this.place.replaceChildren(this.svg);
  }

  /** Return the cell at a point of the window, and the nearest side of it. */
  spotAt({ clientX, clientY }) {
    const { left, top, width } = this.svg.getBoundingClientRect();
    const { width: columns, height: rows, margin } = this.game.data;
    const scale = this.svg.viewBox.baseVal.width / width;
    const [x, y] = [clientX - left, clientY - top].map((at) => (scale * at - margin) / COMMON.cell);
    const cell = [Math.floor(x), Math.floor(y)];
    const isInside = cell[0] >= 0 && cell[1] >= 0 && cell[0] < columns && cell[1] < rows;
    const [dx, dy] = [x - cell[0], y - cell[1]];
    const distances = { N: dy, E: 1 - dx, S: 1 - dy, W: dx };
    const side = "NESW".split("").reduce((best, each) => (distances[each] < distances[best] ? each : best));
    return { cell: isInside ? cell : null, side, distance: distances[side] };
  }
}
