// The rail of tools, and the options of the one at hand.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { capital } from "../../../render/static/game.js";
import { element } from "../../../render/static/paint.js";
import { listenToArrows, markChosen } from "../../../render/static/steps.js";
import { tapped } from "./html.js";
import { MIRRORS, mirror } from "./region.js";
import { TOOLS, toolNamed } from "./tools.js";

/** Return an icon of strokes in a square of 24 by 24. */
function iconElement(path) {
  return element("svg", { viewBox: "0 0 24 24", class: "icon", "aria-hidden": true }, element("path", { d: path }));
}

/**
 * Return a button with an icon, and a name where there is room, or with a text, and the key that does the same.
 *
 * @param {{ icon?: string, key?: string, text?: string, named?: string, title?: string, [attribute: string]: any }} shown
 * @param {(event: Event) => void} [onclick]
 */
export function toolButton({ icon, key, text, named, title, ...attributes }, onclick) {
  const shown = [
    icon === undefined ? null : iconElement(icon),
    named === undefined ? null : html("span", { class: "tool-name", "aria-hidden": "true" }, named),
    text ?? null,
    key === undefined ? null : html("kbd", { "aria-hidden": "true" }, key),
  ];
  const label = text === undefined ? title : undefined;
  return html("button", { type: "button", title, "aria-label": label, onclick, ...attributes }, ...shown);
}

const SHAPES = ["key", "coin", "gem", "star", "box"];
const RAIL_KEYS = { ArrowUp: -1, ArrowLeft: -1, ArrowDown: 1, ArrowRight: 1 };

/** The buttons of the tools and of what changes brushes: a toolbar that arrow keys move in. */
export class Rail {
  constructor(editor, place) {
    this.editor = editor;
    this.tools = TOOLS.map((tool) =>
      railButton("data-tool", tool, tapped(`${tool.title} (${tool.key}): ${tool.hint}`), () => {
        editor.choose(tool.name);
        place.hidePopover();
      }),
    );
    this.modifiers = COMMON.modifiers.map((each) =>
      railButton("data-modifier", each, `${each.title}: ${each.hint}`, () => editor.toggle(each.name)),
    );
    place.append(...this.tools, ...this.modifiers);
    listenToArrows(place, (each) => editor.choose(each.dataset.tool ?? editor.tool), RAIL_KEYS);
    editor.on("tool", () => this.show());
    editor.on("mode", () => place.toggleAttribute("inert", editor.mode !== "edit"));
    this.show();
  }

  show() {
    const { tool, modifiers } = this.editor;
    const chosen = this.tools.find(({ dataset }) => dataset.tool === tool);
    markChosen(this.tools, chosen, "aria-pressed");
    chosen.scrollIntoView({ block: "nearest", inline: "nearest" });
    for (const button of this.modifiers) button.setAttribute("aria-pressed", modifiers[button.dataset.modifier]);
  }
}

/** Return the button of a tool, or of what changes brushes, which has its name as an attribute. */
function railButton(attribute, { name, title: named, icon, key }, title, onclick) {
  const shown = { icon, named, title, "aria-label": named, "aria-keyshortcuts": key, [attribute]: name };
  return toolButton(shown, onclick);
}

/** What the tool at hand draws, in words, with the fields that can be chosen beforehand. */
export class Options {
  constructor(editor, place, tools) {
    this.editor = editor;
    this.place = place;
    this.tools = tools;
    editor.on("tool", () => this.show());
    this.show();
  }

  /** Return the button that opens the tools where they are a sheet. */
  sheet({ icon, title }) {
    const button = toolButton({ icon, text: title, class: "tool-sheet", title: "Tools" });
    button.popoverTargetElement = this.tools;
    return button;
  }

  show() {
    const { tool } = this.editor;
    if (this.shown === tool) return this.refresh();
    this.shown = tool;
    const { icon, title, hint: told } = toolNamed(tool);
    const hint = tapped(told);
    const fields = { glass: this.glass, area: this.area, item: this.item, stamp: this.mirrors }[tool];
    this.place.replaceChildren(
      this.sheet({ icon, title }),
      html("strong", {}, title),
      ...(fields?.call(this) ?? []),
      html("span", { class: "hint", title: hint }, hint),
    );
    return this.refresh();
  }

  /** Show the values at hand in the fields. */
  refresh() {
    const { tool, options } = this.editor;
    for (const button of this.place.querySelectorAll("[data-axis]"))
      button.setAttribute("aria-pressed", options.stamp.mirror.includes(button.dataset.axis));
    for (const field of this.place.querySelectorAll("[data-option]")) {
      const value = options[tool]?.[field.dataset.option];
      if (field.tagName === "BUTTON") field.setAttribute("aria-pressed", value === field.value);
      else if (field.getRootNode().activeElement !== field) field.value = value ?? "";
    }
  }

  choose(name, value) {
    const { tool, options } = this.editor;
    const { [name]: before, ...others } = options[tool];
    this.editor.set("tool", {
      options: { ...options, [tool]: value === undefined ? others : { ...others, [name]: value } },
    });
  }

  field(name, title, attributes, read) {
    const input = html("input", { ...attributes, "data-option": name });
    input.addEventListener("input", () => input.checkValidity() && this.choose(name, read(input)));
    return html("label", {}, title, input);
  }

  number(name, title, attributes) {
    return this.field(name, title, { type: "number", ...attributes }, ({ value }) =>
      value === "" ? undefined : Number(value),
    );
  }

  glass() {
    return [this.number("pass", "Lets through", { min: 0.05, max: 0.95, step: 0.05, required: "" })];
  }

  area() {
    return [
      this.field("color", "Colour", { type: "color" }, ({ value }) => value),
      this.number("reward", "Reward", { step: "any", placeholder: "as it is" }),
    ];
  }

  mirrors() {
    return MIRRORS.map(({ axis, ...shown }) =>
      toolButton({ ...shown, "data-axis": axis }, () => mirror(this.editor, axis)),
    );
  }

  item() {
    const buttons = SHAPES.map((value) =>
      toolButton({ text: capital(value), value, "data-option": "shape" }, () => this.choose("shape", value)),
    );
    return [html("span", { class: "choices", role: "group", "aria-label": "Shape" }, ...buttons)];
  }
}
