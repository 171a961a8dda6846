// Pages of a file system cannot be fetched: there, the results of a search have no excerpts.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;

// What is wider than the page can be scrolled with keys.
addEventListener("load", () => {
  for (const box of document.querySelectorAll("pre, .table-wrapper, .cell_output")) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
});

/** Offer to change a level in its place, and in the editor. */
function offer(tries) {
  const [button, link] = tries.children;
  const level = tries.parentElement;
  const { href } = link;
  let place = null;
  tries.hidden = false;
  button.addEventListener("click", async () => {
    level.classList.toggle("changed", place === null);
    if (place !== null) {
      button.textContent = "Change";
      place.remove();
      place = null;
      link.href = href;
      return;
    }
    button.textContent = "Back to the example";
    place = document.createElement("div");
    place.className = "playground";
    level.prepend(place);
    const { default: playground } = await import(new URL("playground.js", href));
    playground.show(place, tries.dataset.text, (text) => (link.hash = encodeURIComponent(text)));
  });
}

// The editor is for web servers.
if (location.protocol !== "file:") document.querySelectorAll(".tries").forEach(offer);
