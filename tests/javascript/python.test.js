import assert from "node:assert/strict";
import { mock, test } from "node:test";

import { Python, PythonConnection } from "../../babyrobot_levels/extensions/editor/static/python.js";

const workers = [];

/** A worker that answers with the name of what is called, and never to what `deaf` names. */
class FakeWorker {
  static deaf = "";

  constructor() {
    this.called = [];
    workers.push(this);
  }

  postMessage([number, name, ...given]) {
    this.called.push(name);
    if (FakeWorker.deaf !== "" && JSON.stringify(given).includes(FakeWorker.deaf)) return;
    queueMicrotask(() => this.onmessage({ data: [number, JSON.stringify({ called: name }), null] }));
  }

  terminate() {}
}

globalThis.Worker = FakeWorker;
globalThis.location = { origin: "https://example.org", pathname: "/editor/" };

/** Return a connection whose editor keeps what is said. */
function connected() {
  workers.length = 0;
  FakeWorker.deaf = "";
  const connection = new PythonConnection(new Python(), "version: 1\n", "mine");
  const said = [];
  connection.editor = { state: null, say: (text) => said.push(text) };
  return { connection, said };
}

/** Send a message that nobody answers for half a minute. */
async function sendInVain(connection, message) {
  mock.timers.enable({ apis: ["setTimeout"] });
  const sent = assert.rejects(connection.send(message), /longer than 30 seconds/);
  await new Promise((resolve) => setImmediate(resolve));
  mock.timers.tick(30_000);
  mock.timers.reset();
  await sent;
}

test("a session begins once, and anew in another worker, with what was loaded before", async () => {
  const { connection } = connected();
  await connection.send({ do: "state" });
  await connection.more.load();
  FakeWorker.deaf = "undo";
  await sendInVain(connection, { do: "undo" });
  await connection.send({ do: "state" });
  assert.deepEqual(
    workers.map(({ called }) => called),
    [
      ["begin", "reply", "load", "reply"],
      ["load", "begin", "reply"],
    ],
  );
});

test("values that take too long are not asked for again, and everything else is", async () => {
  const { connection, said } = connected();
  FakeWorker.deaf = "answers";
  await sendInVain(connection, { do: "answers" });
  assert.match(said[0], /^Values of this level/);
  assert.deepEqual(await connection.send({ do: "answers" }), {});
  assert.deepEqual(await connection.send({ do: "undo" }), { called: "reply" });
  assert.equal(workers.length, 2);
});
