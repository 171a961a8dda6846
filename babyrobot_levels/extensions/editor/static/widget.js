// The editor in a notebook cell: its messages go to the kernel.

import { mount } from "./mount.js";
import { STYLE } from "./style.js";

const SILENT = "The kernel does not answer: it is busy, or was restarted. If so, run the cell again.";
const PATIENCE = 15000;
let views = 0;

/** Return the colour scheme of the notebook, which may be another one than the system's. */
function schemeOf({ documentElement, body }) {
  const { jpThemeLight, vscodeThemeKind = documentElement.getAttribute("theme") } = body.dataset;
  if (jpThemeLight !== undefined) return jpThemeLight === "true" ? "light" : "dark";
  if (vscodeThemeKind !== null) return vscodeThemeKind.endsWith("light") ? "light" : "dark";
  return "light dark";
}

function render({ model, el }) {
  // Several views of one widget hear the replies of all.
  const view = `${Date.now().toString(36)}-${(views += 1)}`;
  const waiting = new Map();

  const connection = {
    ends: false,

    send(message) {
      const id = `${view}-${message.id}`;
      return new Promise((resolve, reject) => {
        const late = () => waiting.delete(id) && reject(new Error(SILENT));
        const timer = setTimeout(late, PATIENCE);
        waiting.set(id, (reply) => {
          clearTimeout(timer);
          resolve(reply);
        });
        model.send({ ...message, id });
      });
    },
  };

  const place = document.createElement("div");
  el.append(place);
  // Jupyter's menu is for what is outside.
  el.dataset.jpSuppressContextMenu = "true";
  const editor = mount(place, connection, STYLE);
  const follow = () => (place.style.colorScheme = schemeOf(document));
  const themes = new MutationObserver(follow);
  for (const each of [document.documentElement, document.body]) themes.observe(each, { attributes: true });
  follow();

  const hear = (reply) => {
    const resolve = waiting.get(reply.id);
    waiting.delete(reply.id);
    if (resolve !== undefined) return resolve(reply);
    const { state } = editor.completed(reply);
    if (state !== undefined) editor.show(state);
  };
  model.on("msg:custom", hear);
  return () => {
    themes.disconnect();
    model.off("msg:custom", hear);
  };
}

export default { render };
