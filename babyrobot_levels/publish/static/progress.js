// What the visitor has reached: kept in the browser, for all levels by their digests.

export const STORE = "babyrobot:progress";

/**
 * Return the progress in all levels; nothing if there is none, or no storage.
 *
 * @returns {Record<string, any>}
 */
export function storedProgress() {
  try {
    const found = JSON.parse(localStorage.getItem(STORE));
    return found !== null && typeof found === "object" && !Array.isArray(found) ? found : {};
  } catch {
    return {};
  }
}

/**
 * Keep the progress in all levels; without storage, this fails.
 *
 * @param {Record<string, any>} progress
 */
export function storeProgress(progress) {
  localStorage.setItem(STORE, JSON.stringify(progress));
}
