#!/usr/bin/env bash
# scorm-again plays a school's side of SCORM 1.2 without two of its rules, so that pages which pass with it fail in Moodle.
#
# Packages: scorm-again 3.4.3 (npm; needs Node.js)
# Tried: 2026-11-28, Node.js 20
# Expected: a lesson that ends as "not attempted" has become "completed" (SCORM 1.2, LMSFinish), and `cmi.suspend_data` of more than
#   4,096 characters is refused.
# Seen: the status stays "not attempted", and 64,000 characters are taken without an error; 64,001 are refused.
# Why it matters: in Moodle, which keeps the first rule, a level that was opened and closed counts as done, and who stores
#   an episode in `suspend_data` loses it where the second holds. Tests with this stand-in show neither.
# Here: pages set "incomplete" when they begin, and store little; the side of the school in tests has the first rule
#   (tests/extensions/publish/test_scorm_in_browser.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
echo '{"private": true}' >package.json
npm install --silent --no-audit --no-fund scorm-again@3.4.3
node - <<'EOF'
const { readFileSync } = require("node:fs");
const { runInThisContext } = require("node:vm");
const folder = "node_modules/scorm-again";
console.log("scorm-again", JSON.parse(readFileSync(`${folder}/package.json`)).version);
runInThisContext(readFileSync(`${folder}/dist/scorm12.min.js`, "utf8"));

function school() {
  const api = new Scorm12API({ autocommit: false, logLevel: 5 });
  api.LMSInitialize("");
  return api;
}

const lesson = school();
const before = lesson.LMSGetValue("cmi.core.lesson_status");
lesson.LMSFinish("");
const after = lesson.cmi.core.lesson_status;
console.log(`status: ${before}; expected after LMSFinish: completed; seen: ${after}`);
const stored = (length) => school().LMSSetValue("cmi.suspend_data", "x".repeat(length));
console.log(`suspend_data of 4,096: ${stored(4096)}; expected of 4,097: false; seen: ${stored(4097)}`);
console.log(`of 64,000: ${stored(64000)}, of 64,001: ${stored(64001)}`);
const found = [before, after, stored(4096), stored(4097), stored(64000), stored(64001)].map(String);
const as_told = ["not attempted", "not attempted", "true", "true", "true", "false"];
if (found.join() !== as_told.join()) throw new Error(found.join());
EOF
