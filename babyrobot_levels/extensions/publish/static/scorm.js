// A level in the course of a school's system: tells it, by SCORM 1.2, of the best episode so far.
//
// The page of the level plays in a frame, and knows no optimum. The score is 100 for a good end,
// else 0, and `cmi.suspend_data` is the play, which `babyrobot score` verifies.

const LONGEST = 4096; // characters of `cmi.suspend_data`
const WINDOWS = 20; // that are asked for the system's side, from within

const system = systemOf(window) ?? systemOf(window.opener);
const frame = /** @type {HTMLIFrameElement} */ (document.querySelector("iframe"));
const begun = Date.now();

/** Return the school's side of SCORM: an object of this window, or of one around it. @param {any} place */
function systemOf(place) {
  try {
    for (let left = WINDOWS; place && left > 0; left--) {
      if (place.API) return place.API;
      place = place.parent === place ? null : place.parent;
    }
  } catch {
    // A window of another site tells nothing.
  }
  return null;
}

/** Return the score and the return of the best episode so far. */
function best() {
  const score = Number.parseFloat(system.LMSGetValue("cmi.core.score.raw"));
  const play = system.LMSGetValue("cmi.suspend_data");
  const total = play ? JSON.parse(play).return : Number.NEGATIVE_INFINITY;
  return { score: Number.isNaN(score) ? -1 : score, total };
}

/** Tell of an episode, if it is the best one. @param {any} game */
function tell(game) {
  const play = /** @type {any} */ (frame.contentWindow).playLine(game)?.trim() ?? "";
  const score = game.isGood ? 100 : 0;
  const before = best();
  if (score < before.score || (score === before.score && game.total <= before.total)) return;
  system.LMSSetValue("cmi.core.score.min", "0");
  system.LMSSetValue("cmi.core.score.max", "100");
  system.LMSSetValue("cmi.core.score.raw", String(score));
  system.LMSSetValue("cmi.core.lesson_status", score ? "passed" : "incomplete");
  system.LMSSetValue("cmi.suspend_data", play.length > LONGEST ? "" : play);
  system.LMSCommit("");
}

/** Return the time since the page was opened, as SCORM writes it: `0000:01:02`. */
function time() {
  const seconds = Math.floor((Date.now() - begun) / 1000);
  const parts = [seconds / 3600, (seconds / 60) % 60, seconds % 60];
  return parts.map((part, index) => String(Math.floor(part)).padStart(index ? 2 : 4, "0")).join(":");
}

/** Return who plays, as the system knows them: `Lovelace, Ada (1815)`. */
function player() {
  const [name, id] = ["name", "id"].map((each) => system.LMSGetValue(`cmi.core.student_${each}`));
  return name && id ? `${name} (${id})` : name || id;
}

let page = "level.html";
if (system) {
  system.LMSInitialize("");
  // When a page ends that says nothing, systems take "not attempted" for "completed".
  if (["", "not attempted"].includes(system.LMSGetValue("cmi.core.lesson_status"))) {
    system.LMSSetValue("cmi.core.lesson_status", "incomplete");
    system.LMSCommit("");
  }
  page += `?player=${encodeURIComponent(player())}`;
  frame.addEventListener("load", () =>
    frame.contentDocument?.addEventListener("episodeend", (/** @type {any} */ { detail }) => tell(detail)),
  );
  addEventListener("pagehide", () => {
    system.LMSSetValue("cmi.core.session_time", time());
    system.LMSSetValue("cmi.core.exit", "suspend");
    system.LMSFinish("");
  });
}
frame.src = page;
