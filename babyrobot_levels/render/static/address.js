// What is learned, in the address of a page: after the level that it may hold.

/** @param {string} fragment */
export function decoded(fragment) {
  try {
    return decodeURIComponent(fragment);
  } catch {
    return fragment;
  }
}

/**
 * Return what a fragment tells to learn, by the names of options; `learn` is the algorithm.
 *
 * @param {string} fragment
 */
export function runOf(fragment) {
  return new URLSearchParams(/[#&](learn=.*)/s.exec(decoded(fragment))?.[1]);
}

/**
 * Have the address tell what is learned, or nothing of it; return whether the page has an address.
 *
 * @param {string} run
 */
export function keepRun(run) {
  const [level] = /brl[^&]*|$/i.exec(decoded(location.hash));
  const fragment = [level, run].filter(Boolean).join("&");
  try {
    history.replaceState(null, "", fragment ? `#${fragment}` : location.pathname + location.search);
    return true;
  } catch {
    return false;
  }
}
