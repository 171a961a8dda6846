// Controls for the fields of a level, by the types of `editor/forms.py`.

import { COMMON } from "../../../render/static/common.js";
import { html } from "../../../render/static/dom.js";
import { button } from "./html.js";

const HOLD_PAUSE = 350; // Milliseconds that a stepper is held before it repeats,
const REPEAT_PAUSE = 160; // and between its first steps, which become ever shorter,
const SHORTEST_PAUSE = 30; // down to this.

/**
 * Each control has an `element`; `show(value)` shows a value, undefined for one that is not given;
 * `change(value)`, which it is made with, is called when it was changed, null for nothing.
 */
export const CONTROLS = {
  number: numberControl,
  integer: numberControl,
  text: textControl,
  choice: choiceControl,
  flag: flagControl,
  color: colorControl,
  names: namesControl,
  texts: textsControl,
  cell: pairControl,
  size: pairControl,
};

/** Return a button that repeats while it is held: `step(isLast)`, faster and faster. */
function holdButton(shown, label, step, done) {
  const made = button(shown, { class: "step", "aria-label": label, tabindex: "-1" });
  let timer = null;
  let pause = 0;
  const repeat = () => {
    step();
    pause = Math.max(SHORTEST_PAUSE, pause * 0.88);
    timer = setTimeout(repeat, pause);
  };
  const end = () => {
    if (timer === null) return;
    clearTimeout(timer);
    timer = null;
    done();
  };
  made.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    made.setPointerCapture(event.pointerId);
    pause = REPEAT_PAUSE;
    step();
    timer = setTimeout(repeat, HOLD_PAUSE);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) made.addEventListener(name, end);
  made.addEventListener("contextmenu", (event) => event.preventDefault());
  made.addEventListener("click", (event) => {
    if (event.detail > 0) return; // By a pointer, whose press has done it.
    step();
    done();
  });
  return made;
}

/** Return buttons for the words that may stand in the place of a value, and how to show which does. */
function wordButtons({ choices = [], default: usual }, change) {
  const buttons = choices.map((word) =>
    button(word, { class: "word", onclick: ({ currentTarget }) => change(word, currentTarget.ariaPressed === "true") }),
  );
  const show = (value) => {
    for (const each of buttons) each.ariaPressed = String(each.textContent === (value ?? usual));
  };
  return { buttons, show };
}

/** A number with steppers. */
export function numberControl(field, change) {
  const { label, type, minimum, maximum, default: usual } = field;
  const isWhole = type === "integer";
  const step = isWhole || maximum === undefined || maximum > 1 ? 1 : 0.05;
  const input = html("input", {
    type: "text",
    inputmode: isWhole ? "numeric" : "decimal",
    "aria-label": label,
    placeholder: usual ?? "–",
    autocomplete: "off",
  });
  let given;
  const read = () => {
    const written = input.value.trim().replace(",", ".");
    return written === "" ? null : Number.isNaN(Number(written)) ? written : Number(written);
  };
  const done = () => {
    if (read() !== (given ?? null)) change(read());
  };
  const by = (difference) => {
    const now = [read(), usual, minimum].find((each) => typeof each === "number") ?? 0;
    const next = Math.round((now + difference) * 1e6) / 1e6;
    input.value = Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, next));
  };
  const less = holdButton("−", `less ${label}`, () => by(-step), done);
  const more = holdButton("+", `more ${label}`, () => by(step), done);
  input.addEventListener("change", done);
  const arrows = { ArrowUp: step, ArrowDown: -step };
  input.addEventListener("keydown", (event) => {
    if (!(event.key in arrows)) return;
    event.preventDefault();
    by(arrows[event.key]);
  });
  input.addEventListener("keyup", ({ key }) => key in arrows && done());
  const words = wordButtons(field, (word, isChosen) => change(isChosen ? (minimum ?? 0) : word));
  const element = html(
    "span",
    { class: "number-control" },
    html("span", { class: "stepper" }, less, input, more),
    ...words.buttons,
  );
  const show = (value) => {
    given = value;
    // A mapping, such as a reward that is drawn, is changed in the text.
    input.value = typeof value === "object" ? "" : (value ?? "");
    words.show(value);
  };
  return { element, show, read };
}

function textControl({ label, name, default: usual }, change) {
  const isLong = name === "description";
  const element = html(isLong ? "textarea" : "input", {
    type: isLong ? undefined : "text",
    rows: isLong ? "3" : undefined,
    "aria-label": label,
    placeholder: usual ?? "",
    autocomplete: "off",
  });
  return { element, show: textField(element, change) };
}

/** Call `change` when another text was written in a field, null for none; return what shows a value in it. */
function textField(input, change) {
  let given;
  input.addEventListener("change", () => {
    const text = input.value.trim();
    if (text !== (given ?? "")) change(text === "" ? null : text);
  });
  return (value) => {
    given = value;
    input.value = value ?? "";
  };
}

/** Several texts in one line, such as tags. */
function textsControl(field, change) {
  const control = textControl(field, (written) =>
    change(written === null ? null : written.split(/[\s,]+/).filter((word) => word !== "")),
  );
  return { ...control, show: (value) => control.show(value === undefined ? value : [value].flat().join(", ")) };
}

function choiceControl({ label, choices, default: usual }, change) {
  const options = choices.map((choice) => html("option", { value: choice }, choice));
  const none = html("option", { value: "" }, "–");
  const element = html("select", { "aria-label": label }, ...(choices.includes(usual) ? [] : [none]), ...options);
  element.addEventListener("change", () => change(element.value === "" ? null : element.value));
  return { element, show: (value) => (element.value = value ?? usual ?? "") };
}

function flagControl({ label, default: usual }, change) {
  const element = html("input", { type: "checkbox", "aria-label": label });
  element.addEventListener("change", () => change(element.checked));
  return { element, show: (value) => (element.checked = value ?? usual ?? false) };
}

/** A colour by its name or digits, or from a palette. */
function colorControl({ label, default: usual }, change) {
  const name = html("input", {
    type: "text",
    "aria-label": label,
    placeholder: usual ?? "of the theme",
    autocomplete: "off",
  });
  const palette = html("input", { type: "color", "aria-label": `${label}: palette` });
  palette.addEventListener("change", () => change(palette.value));
  const element = html("span", { class: "color" }, palette, name);
  const showName = textField(name, change);
  const show = (value) => {
    showName(value);
    palette.value = digitsOf(value ?? usual ?? "#888888");
    element.classList.toggle("unset", value === undefined);
  };
  return { element, show };
}

/** @type {{ fillStyle: any }} */
const PEN = document.createElement("canvas").getContext("2d"); // Knows all colours.
const DIGITS = new Map();

/** Return a CSS colour as `#rrggbb`, without its alpha. */
export function digitsOf(written) {
  if (!DIGITS.has(written)) {
    PEN.fillStyle = written;
    const channels = PEN.fillStyle.startsWith("#") ? null : PEN.fillStyle.match(/[\d.]+/g).slice(0, 3);
    const hex = (channel) => Number(channel).toString(16).padStart(2, "0");
    DIGITS.set(written, channels === null ? PEN.fillStyle : `#${channels.map(hex).join("")}`);
  }
  return DIGITS.get(written);
}

/** Check boxes for names of what there is. */
function namesControl({ label, choices }, change) {
  const element = html("span", { class: "names", role: "group", "aria-label": label });
  const show = (value, known = choices ?? []) => {
    const given = value === undefined ? [] : [value].flat();
    const names = [...new Set([...known, ...given])];
    const boxes = names.map((name) => html("input", { type: "checkbox", value: name, checked: given.includes(name) }));
    const collect = () => {
      const chosen = boxes.filter(({ checked }) => checked).map((box) => box.value);
      change(chosen.length === 0 ? null : chosen);
    };
    for (const box of boxes) box.addEventListener("change", collect);
    const labels = boxes.map((box) => html("label", { class: "check" }, box, box.value));
    element.replaceChildren(...(labels.length === 0 ? [`There are no ${COMMON.none_needed} yet.`] : labels));
  };
  return { element, show };
}

/** A cell or a size: two whole numbers. */
export function pairControl(field, change) {
  const { label, type, minimum = type === "size" ? 1 : 0, maximum, default: usual } = field;
  const names = type === "size" ? ["width", "height"] : ["column", "row"];
  let given = null;
  const one = (index) =>
    numberControl(
      { label: `${label}: ${names[index]}`, type: "integer", minimum, maximum, default: usual?.[index] },
      (number) => {
        const pair = [0, 1].map((each) => given?.[each] ?? usual?.[each] ?? minimum);
        pair[index] = number ?? usual?.[index] ?? minimum;
        change(pair);
      },
    );
  const pair = [one(0), one(1)];
  const words = wordButtons(field, (word, isChosen) => change(isChosen ? [minimum, minimum] : word));
  const element = html("span", { class: "pair" }, ...pair.map((each) => each.element), ...words.buttons);
  const show = (value) => {
    given = Array.isArray(value) ? value : null;
    pair.forEach((each, index) => each.show(given?.[index]));
    words.show(value);
  };
  return { element, show };
}
