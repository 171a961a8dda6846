// The editor in a window of its own, whoever answers its messages.

import { mount } from "./mount.js";

/** Show an editor that fills the window; `connection` is that of `mount`. */
export async function fillWindow(connection) {
  const page = new CSSStyleSheet();
  page.replaceSync("html, body, #editor { height: 100%; margin: 0; font-family: system-ui, sans-serif }");
  document.adoptedStyleSheets = [page];
  const style = await (await fetch("editor.css")).text();
  const editor = mount(document.querySelector("#editor"), connection, style);
  editor.stage.place.focus(); // The window's keys are the editor's.
  editor.on("state", () => {
    const { is_saved, level, name, path } = editor.state;
    document.title = `${is_saved ? "" : "* "}${level?.title ?? path ?? name ?? "Level"} – editor`;
  });
  return editor;
}
