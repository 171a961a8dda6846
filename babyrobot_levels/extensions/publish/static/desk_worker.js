// The worker of a course's page: it runs Python, and in it the functions of students.
// What comes is [name, kind, text, levels as JSON]; for each level, a result as JSON goes back.

// @ts-expect-error: the page has it beside this file.
import { loadPyodide } from "./python/pyodide.mjs";

const NO_NUMPY =
  "NumPy is not in this page's folder, and could not be loaded from elsewhere. Write the function without it, with lists: mdp.probability[state, action] is one of them.";

async function start() {
  const source = fetch("hashed.py");
  // Packages need an address that is whole.
  const packageBaseUrl = new URL("NUMPY_ADDRESS", self.location.href).href;
  const python = await loadPyodide({ indexURL: "./python/", packageBaseUrl });
  const answer = await source;
  if (!answer.ok) throw new Error(`hashed.py: ${answer.status}`);
  python.FS.writeFile("hashed.py", await answer.text());
  return python;
}

const started = start();
started.catch((error) => self.postMessage({ failed: `Python cannot be started here (${error.message}).` }));

/** Load NumPy if a text imports it, and return whether it is there. */
async function hasNumpy(python, text) {
  if (!/^\s*(import|from)\s+numpy\b/m.test(text)) return true;
  try {
    await python.loadPackage("numpy");
    // What could not be loaded is only told in the console.
    python.runPython("import numpy");
    return true;
  } catch {
    return false;
  }
}

self.onmessage = async ({ data: [name, kind, text, levels] }) => {
  const python = await started;
  if (!(await hasNumpy(python, text))) {
    self.postMessage({ failed: NO_NUMPY });
    return;
  }
  self.postMessage({ isRunning: true });
  const run = python.pyimport("hashed").run;
  for (const level of levels) self.postMessage({ result: JSON.parse(run(text, name, kind, level)) });
};
