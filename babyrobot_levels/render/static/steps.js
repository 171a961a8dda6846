// A row of buttons of which one is chosen, such as tabs.

/** Mark the chosen button of a row by an attribute; Tab comes to it alone. */
export function markChosen(row, chosen, attribute = "aria-selected") {
  for (const each of row) {
    each.setAttribute(attribute, each === chosen);
    each.tabIndex = each === chosen ? 0 : -1;
  }
}

/** Have arrow keys choose the button before or after the one with the focus, and Home and End the outermost. */
export function listenToArrows(row, choose, ways = { ArrowLeft: -1, ArrowRight: 1 }) {
  row.addEventListener("keydown", (event) => {
    const all = [...row.children].filter((each) => each.checkVisibility());
    const at = all.indexOf(event.target);
    const way = ways[event.key];
    const place = way === undefined ? { Home: 0, End: -1 }[event.key] : (at + way) % all.length;
    if (at < 0 || place === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    choose(all.at(place));
    all.at(place).focus();
  });
}
