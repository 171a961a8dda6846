/** What is the same for all levels: see `common_data`. @type {Common} */
export const COMMON = JSON.parse(document.getElementById("common").textContent);
