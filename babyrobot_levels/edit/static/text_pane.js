// The text beside the picture.

class TextPane {
  constructor(editor, area) {
    this.editor = editor;
    this.area = area;
    editor.on("state", () => {
      if (area.value !== editor.state.text) area.value = editor.state.text;
    });
    area.addEventListener("input", () => editor.send({ do: "text", text: area.value }));
  }
}
