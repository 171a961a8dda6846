// The editor in a place of a document: a shadow root, so that styles neither leave nor enter it.

const LAYOUT = `
<div class="editor">
<header class="bar"></header>
<nav class="tools" role="toolbar" aria-label="Tools"></nav>
<div class="view">
<div class="stage" tabindex="0" role="application" aria-roledescription="level"></div>
<p class="said" role="status" aria-live="polite"></p>
</div>
<aside class="panels">
<section class="answers"></section>
<section class="inspector"></section>
<section class="findings"></section>
<section class="file"></section>
</aside>
</div>
`;

/**
 * Show an editor in an element.
 *
 * `connection.send(message)` returns a promise of the reply; `style` is the style sheet.
 */
export function mount(place, connection, style = "") {
  const root = place.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style);
  root.adoptedStyleSheets = [sheet];
  root.innerHTML = LAYOUT;
  const find = (name) => root.querySelector(`.${name}`);
  const editor = new Editor(connection);
  new Stage(editor, find("stage"));
  new Findings(editor, find("findings"));
  new TextPane(editor, find("file"));
  editor.on("said", () => (find("said").textContent = editor.said));
  editor.send({ do: "state" });
  return editor;
}
