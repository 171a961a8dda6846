// The wall of a gallery: filters, search, order, films, and the visitor's progress. The address
// after its `#` holds what is chosen, so that it can be linked and the Back button returns to it.

import { byId, html, keepData, starSigns } from "../../../render/static/dom.js";
import { STORE, storedProgress } from "../../../render/static/progress.js";

const SORTS = ["size", "difficulty", "steps", "return"];
const FILM_DELAY = 150; // Milliseconds: the pointer passes over tiles on its way to another.
const TYPING_DELAY = 250;

const folded = (text) => text.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase();

const wall = byId("wall");
const form = byId("filters");
const query = byId("query");
const order = byId("order");
const boxes = [...form.querySelectorAll("input[type='checkbox']")];
const ends = [...form.querySelectorAll("input[type='number']")]; // Of a range of difficulty.
const numbersAt = boxes.map((box) => box.parentElement.querySelector(".n"));
const facetOf = boxes.map((box) => box.name);
const [solvedPlace, openPlace] = ["solved", "open"].map((value) =>
  boxes.findIndex((box) => box.name === "progress" && box.value === value),
);
const compare = new Intl.Collator("en", { numeric: true }).compare;

const rows = JSON.parse(byId("tiles").textContent);
// In the chosen order. The wall contains those that are shown: hiding the others takes longer.
const tiles = [...wall.children].map((element, index) => {
  const [places, text, digest, ...numbers] = rows[index];
  const title = element.querySelector("h2").textContent;
  element.querySelector("a").search = location.search; // Who plays.
  return { element, places, text: folded(`${title}\n${text}`), title, digest, numbers, index, isSolved: false };
});

// What is chosen, and the address.

function chosen() {
  const state = new URLSearchParams();
  if (query.value.trim()) state.set("q", query.value.trim());
  boxes.filter((box) => box.checked).forEach((box) => state.append(box.name, box.value));
  ends.filter((end) => end.value).forEach((end) => state.set(end.id, end.value));
  if (order.value) state.set("sort", order.value);
  return state.toString();
}

let typing = 0;
function remember(isTyping) {
  clearTimeout(typing);
  if (isTyping) typing = setTimeout(() => setAddress("replaceState"), TYPING_DELAY);
  else setAddress("pushState");
}

function setAddress(method) {
  const hash = chosen();
  if (hash !== location.hash.slice(1))
    history[method](null, "", hash ? `#${hash}` : location.pathname + location.search);
}

function recall() {
  const state = new URLSearchParams(location.hash.slice(1));
  query.value = state.get("q") ?? "";
  boxes.forEach((box) => (box.checked = state.getAll(box.name).includes(box.value)));
  ends.forEach((end) => (end.value = state.get(end.id) ?? ""));
  order.value = state.get("sort") ?? "";
  if (order.selectedIndex < 0) order.value = "";
  form.querySelectorAll("details:has(:checked)").forEach((each) => (each.open = true));
  sort();
  update();
}

// Filters.

/** Show the tiles that fit, and at each box how many there would be, the other facets as they are. */
function update() {
  const words = folded(query.value).split(/\s+/).filter(Boolean);
  const wanted = new Set(boxes.flatMap((box, place) => (box.checked ? [place] : [])));
  const facets = new Set([...wanted].map((place) => facetOf[place]));
  const counts = boxes.map(() => 0);
  const shown = [];
  const [least, most] = ends.map((end) => end.value && Number(end.value));
  for (const tile of tiles) {
    if (!words.every((word) => tile.text.includes(word))) continue;
    const difficulty = tile.numbers[1] ?? NaN;
    if ((least && !(difficulty >= least)) || (most && !(difficulty <= most))) continue;
    const met = new Set(tile.places.filter((place) => wanted.has(place)).map((place) => facetOf[place]));
    const missed = [...facets].filter((facet) => !met.has(facet));
    if (missed.length === 0) shown.push(tile.element);
    if (missed.length > 1) continue;
    for (const place of tile.places) if (!missed.length || facetOf[place] === missed[0]) counts[place] += 1;
  }
  const current = wall.children;
  if (shown.length !== current.length || shown.some((element, place) => element !== current[place])) {
    wall.replaceChildren(...shown);
  }
  boxes.forEach((box, place) => {
    numbersAt[place].textContent = counts[place];
    box.disabled = !counts[place] && !box.checked;
  });
  tell(wanted, shown.length);
}

/** The visitor has chosen: show it from its beginning. */
function choose(isTyping = false) {
  const top = byId("main").offsetTop;
  const isBelow = scrollY > top;
  update();
  remember(isTyping);
  if (isBelow) scrollTo(0, top);
}

function tell(wanted, shown) {
  const levels = (number) => `${number.toLocaleString("en")} level${number === 1 ? "" : "s"}`;
  byId("count").textContent =
    shown === tiles.length ? levels(shown) : `${shown.toLocaleString("en")} of ${levels(tiles.length)}`;
  byId("none").hidden = shown > 0 || tiles.length === 0;
  byId("show").textContent = `Show ${levels(shown)}`;
  byId("how-many").textContent = wanted.size || "";
  const chips = [...wanted].map((place) => {
    const name = boxes[place].parentElement.querySelector(".name").firstChild.textContent.trim();
    return button(name, () => boxes[place].click(), { "aria-label": `Remove the filter ${name}` });
  });
  if (chosen().replace(/&?sort=.*/, "")) chips.push(button("Clear all", clear, { class: "plain" }));
  byId("chosen").replaceChildren(...chips);
}

function button(text, act, attributes) {
  const onclick = () => {
    act();
    if (!made.isConnected) query.focus({ preventScroll: true });
  };
  const made = html("button", { type: "button", onclick, ...attributes }, text);
  return made;
}

function clear() {
  form.reset();
  query.value = "";
  choose();
}

function sort() {
  const name = order.value.replace("-", "");
  const sign = order.value.startsWith("-") ? -1 : 1;
  const number = (tile) => tile.numbers[SORTS.indexOf(name)] ?? null;
  // Levels without the number come last in both directions.
  const byNumber = (a, b) =>
    Number(number(a) === null) - Number(number(b) === null) || sign * (number(a) - number(b)) || a.index - b.index;
  const rule = { "": (a, b) => a.index - b.index, title: (a, b) => compare(a.title, b.title) }[name] ?? byNumber;
  tiles.sort(rule);
}

// Films: loaded when a tile has the pointer or the focus, and only then.

const isCalm = matchMedia("(prefers-reduced-motion: reduce)");
let playing = null;
let timer = 0;

function play(tile) {
  if (tile === playing) return;
  clearTimeout(timer);
  playing?.querySelector(".film")?.remove();
  playing?.classList.remove("plays");
  playing = tile;
  const address = tile?.querySelector("[data-film]")?.dataset.film;
  if (!address || isCalm.matches) return;
  timer = setTimeout(() => {
    const alt = `A film of ${tile.querySelector("h2").textContent}`;
    const onload = () => tile.classList.toggle("plays", film.isConnected);
    const film = html("img", { class: "film", alt, onload, src: address });
    tile.querySelector(".shot").append(film);
  }, FILM_DELAY);
}

const tileOf = (event) => event.target.closest("#wall > li");
wall.addEventListener("pointerover", (event) => event.pointerType === "mouse" && play(tileOf(event)));
wall.addEventListener("pointerleave", () => play(null));
wall.addEventListener("focusin", (event) => event.target.matches(":focus-visible") && play(tileOf(event)));
wall.addEventListener("focusout", () => play(null));

// The visitor's progress, which the pages of levels write.

function readProgress() {
  const progress = storedProgress();
  for (const tile of tiles) {
    const { solved, stars } = (Object.hasOwn(progress, tile.digest) && progress[tile.digest]) || {};
    tile.isSolved = solved === true;
    tile.places = tile.places.filter((place) => place !== solvedPlace && place !== openPlace);
    tile.places.push(tile.isSolved ? solvedPlace : openPlace);
    mark(tile, [1, 2, 3].includes(stars) ? stars : 0);
  }
  const solved = tiles.filter((tile) => tile.isSolved).length;
  byId("progress").hidden = byId("own").hidden = solved === 0;
  byId("solved").textContent = `${solved.toLocaleString("en")} of ${tiles.length.toLocaleString("en")} solved`;
  byId("solved-bar").max = tiles.length;
  byId("solved-bar").value = solved;
  // As on the pages: the one after the last that was solved.
  const places = new Map(tiles.map(({ digest, index }) => [digest, index]));
  const digests = Object.keys(progress).filter((digest) => progress[digest]?.solved === true);
  const last = digests.reduce((before, digest) => places.get(digest) ?? before, -1);
  const after = ({ index }) => (index - last - 1 + tiles.length) % tiles.length;
  const open = tiles.filter((tile) => !tile.isSolved).sort((a, b) => after(a) - after(b))[0];
  byId("next").hidden = open === undefined;
  if (open !== undefined) {
    byId("next").href = open.element.querySelector("a").href;
    byId("next").textContent = `${solved ? "Next" : "Start here"}: ${open.title}`;
  }
  if (solved === 0) boxes.filter((box) => box.name === "progress").forEach((box) => (box.checked = false));
}

function mark(tile, stars) {
  const link = tile.element.querySelector("a");
  const id = `d${tile.index}`;
  tile.element.querySelector(".done")?.remove();
  link.toggleAttribute("aria-describedby", tile.isSolved);
  if (!tile.isSolved) return;
  const label = stars ? `Solved with ${stars} of 3 stars` : "Solved";
  const signs = stars ? starSigns(stars) : "✓";
  const done = html("span", { class: "done", id, role: "img", "aria-label": label }, signs);
  tile.element.querySelector(".shot").append(done);
  link.setAttribute("aria-describedby", id);
}

function forget() {
  if (!confirm("Forget which of these levels you have solved?")) return;
  const progress = storedProgress();
  tiles.forEach((tile) => delete progress[tile.digest]);
  keepData(STORE, progress);
  refresh();
  query.focus();
}

function refresh() {
  readProgress();
  update();
}

// Where the filters are: beside the wall, or on small windows in a sheet.

const sheet = byId("sheet");
byId("open").addEventListener("click", () => {
  byId("sheet-body").append(form);
  sheet.showModal();
});
sheet.addEventListener("close", () => byId("rail").append(form));
byId("show").addEventListener("click", () => sheet.close());
sheet.addEventListener("click", (event) => event.target === sheet && sheet.close());
matchMedia("(max-width: 60rem)").addEventListener("change", () => sheet.open && sheet.close());

form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("change", () => choose());
order.addEventListener("change", () => {
  sort();
  choose();
});
query.addEventListener("input", () => choose(true));
ends.forEach((end) => end.addEventListener("input", () => choose(true)));
document.querySelectorAll("[data-clear]").forEach((each) => each.addEventListener("click", clear));
byId("forget").addEventListener("click", forget);
document.addEventListener("keydown", (event) => {
  if (event.key !== "/" || event.ctrlKey || event.altKey || event.metaKey || sheet.open) return;
  if (event.target.matches("input:not([type='checkbox']), select")) return;
  event.preventDefault();
  query.focus();
  query.select();
});
addEventListener("popstate", recall);
addEventListener("pageshow", (event) => event.persisted && refresh());
addEventListener("storage", (event) => event.key === STORE && refresh());

readProgress();
document.body.classList.add("ready");
recall();
