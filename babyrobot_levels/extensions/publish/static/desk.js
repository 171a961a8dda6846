// The page in which students write the functions of a course, and see in which levels they are right.

import { byId, html, keepText, recallText, saveFile } from "../../../render/static/dom.js";
import { listenToArrows, markChosen } from "../../../render/static/steps.js";

const SECONDS = 60; // That a function may take in a level.
const INDENT = "    ";

const course = JSON.parse(byId("course").textContent);
const [text, run, stop, save, anew, notice, found, printed, tabs, panel] =
  "text run stop save anew notice found printed tabs panel".split(" ").map(byId);

let chosen = course.functions[0];
/** @type {Worker | null} */
let worker = null;
let isStarted = false;
let timer = 0;
/** The levels whose results are still to come, the first of them running. */
let waiting = [];
let marks = { right: 0, of: 0 };

/** Under what this browser keeps the text of a function. */
const key = (name) => `babyrobot-desk ${location.pathname} ${name}`;

/** Return what was kept of a function, or what the course gives. */
const textOf = ({ name, text }) => recallText(key(name)) ?? text;

function keep() {
  if (!keepText(key(chosen.name), text.value)) tell("This browser keeps nothing for this page: save the file.");
}

function tell(said) {
  notice.textContent = said;
}

/** Show a function, and what is known of it: nothing. */
function choose(wanted) {
  end();
  chosen = wanted;
  const tab = tabs.children[course.functions.indexOf(wanted)];
  markChosen(tabs.children, tab);
  panel.setAttribute("aria-labelledby", tab.id);
  text.value = textOf(wanted);
  text.setAttribute("aria-label", `${wanted.name}.py`);
  found.replaceChildren();
  printed.textContent = "";
  tell("");
}

function begin() {
  isStarted = false;
  worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => hear(data);
  worker.onerror = ({ message }) => stopped(`Python cannot be started here (${message ?? "the worker failed"}).`);
}

/** Run the function in all levels in which it is graded. */
function start() {
  keep();
  end();
  if (worker === null) begin();
  waiting = course.levels.filter(({ functions }) => functions.includes(chosen.name));
  marks = { right: 0, of: waiting.length };
  found.replaceChildren();
  printed.textContent = "";
  run.disabled = true;
  stop.disabled = false;
  tell(isStarted ? "Running …" : "Starting Python, which is about 10 MB the first time …");
  worker.postMessage([chosen.name, chosen.kind, text.value, waiting.map((level) => JSON.stringify(level))]);
}

/** Give the level that runs its time. */
function limit() {
  clearTimeout(timer);
  timer = window.setTimeout(() => {
    show(waiting[0], false, `it took longer than ${SECONDS} seconds: does its loop end?`);
    stopped("Stopped.");
  }, SECONDS * 1000);
}

function hear({ isRunning, failed, result }) {
  if (failed) stopped(failed);
  if (isRunning) {
    isStarted = true;
    tell("Running …");
  }
  if (result && waiting.length) {
    show(waiting.shift(), result.passed, result.message);
    marks.right += Number(result.passed);
    printed.textContent ||= result.printed;
  }
  if (waiting.length) limit();
  else if (result) {
    end();
    tell(`${marks.right} of ${marks.of} levels are right.`);
  }
}

function show(level, passed, message) {
  const word = passed ? "right" : "wrong";
  const cells = [html("th", { scope: "row" }, level.title), html("td", { class: word }, word), html("td", {}, message)];
  found.append(html("tr", {}, ...cells));
}

/** End what runs, with its worker, which may be busy for ever. */
function stopped(said) {
  worker?.terminate();
  worker = null;
  end();
  tell(said);
}

/** Nothing runs any more; what has begun is waited for no longer. */
function end() {
  clearTimeout(timer);
  if (waiting.length) {
    worker?.terminate();
    worker = null;
  }
  waiting = [];
  run.disabled = false;
  stop.disabled = true;
}

/** Put a text in the place of a part of what is written, so that it can be undone. */
function put(said, from, to) {
  text.setSelectionRange(from, to);
  document.execCommand("insertText", false, said);
}

/** Indent the lines of the selection, or take that back. */
function indent(isBack) {
  const { selectionStart, selectionEnd, value } = text;
  const first = value.lastIndexOf("\n", selectionStart - 1) + 1;
  const lines = value.slice(first, selectionEnd).split("\n");
  if (!isBack && lines.length === 1) {
    put(INDENT, selectionStart, selectionEnd);
    return;
  }
  const changed = lines.map((line) => (isBack ? line.replace(/^ {1,4}/, "") : INDENT + line)).join("\n");
  put(changed, first, selectionEnd);
  if (lines.length > 1) text.setSelectionRange(first, first + changed.length);
}

/** Begin a line as deep as the one before, and deeper after a colon. */
function breakLine() {
  const before = text.value.slice(0, text.selectionStart).split("\n").at(-1);
  const deeper = before.trimEnd().endsWith(":") ? INDENT : "";
  put(`\n${before.match(/^ */)[0]}${deeper}`, text.selectionStart, text.selectionEnd);
}

let isLeaving = false; // After Esc, Tab goes on to what is next.
text.addEventListener("keydown", (event) => {
  const isPlain = !event.ctrlKey && !event.metaKey && !event.altKey && !event.isComposing;
  if (event.key === "Tab" && isPlain && !isLeaving) {
    event.preventDefault();
    indent(event.shiftKey);
  } else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault();
    if (!run.disabled) start();
  } else if (event.key === "Enter" && isPlain) {
    event.preventDefault();
    breakLine();
  }
  isLeaving = event.key === "Escape";
});
text.addEventListener("input", keep);
run.addEventListener("click", start);
stop.addEventListener("click", () => stopped("Stopped."));
save.addEventListener("click", () => {
  keep();
  saveFile(`${chosen.name}.py`, text.value, "text/x-python");
});
anew.addEventListener("click", () => {
  if (text.value === chosen.text || confirm(`Throw away what is written in ${chosen.name}.py?`)) {
    text.value = chosen.text;
    keep();
  }
});
for (const [number, each] of course.functions.entries()) {
  const shown = { id: `tab-${number}`, role: "tab", "aria-controls": "panel", onclick: () => choose(each) };
  tabs.append(html("button", shown, `${each.name}.py`));
}
listenToArrows(tabs, (tab) => tab.click());
choose(chosen);
