// The worker of a site: it runs Python, and in it the sessions.
// What is called comes as [number, name, ...arguments] and is answered by [number, result, error].

// @ts-expect-error: sites have it.
import { loadPyodide } from "./python/pyodide.mjs";

const PLACE = "/lib/python3.14/site-packages";

let loaded = 0;
const load = self.fetch;
/** Load as browsers do, and tell how many bytes have come so far. */
self.fetch = async (...given) => {
  const answer = await load(...given);
  const count = new TransformStream({
    transform(part, stream) {
      loaded += part.byteLength;
      self.postMessage([0, loaded, null]);
      stream.enqueue(part);
    },
  });
  return answer.ok && answer.body ? new Response(answer.body.pipeThrough(count), answer) : answer;
};

async function start() {
  const packages = fetch("python/packages.zip");
  // Packages need an address that is whole.
  const packageBaseUrl = new URL("MORE_ADDRESS", self.location.href).href;
  const python = await loadPyodide({ indexURL: "./python/", packageBaseUrl });
  const answer = await packages;
  if (!answer.ok) throw new Error(`python/packages.zip: ${answer.status}`);
  python.unpackArchive(await answer.arrayBuffer(), "zip", { extractDir: PLACE });
  return { python, session: python.pyimport("babyrobot_levels.extensions.editor.browser") };
}

const started = start();

const CALLS = {
  begin: async (...given) => (await started).session.begin(...given),
  reply: async (...given) => (await started).session.reply(...given),
  /** Load the numeric half. */
  load: async () => {
    const { python, session } = await started;
    try {
      await python.loadPackage(["numpy", "scipy"]);
      // What could not be loaded is only told in the console.
      python.runPython("import numpy, scipy");
    } catch {
      throw new Error("NumPy and SciPy could not be loaded: is there a network?");
    }
    session.read_again();
  },
};

self.onmessage = async ({ data: [number, name, ...given] }) => {
  try {
    self.postMessage([number, await CALLS[name](...given), null]);
  } catch (error) {
    const lines = String(/** @type {Error} */ (error).message)
      .trim()
      .split("\n");
    self.postMessage([number, null, lines.at(-1)]);
  }
};
