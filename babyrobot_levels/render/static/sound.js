// Sounds: short tones for what happens, once they are switched on.

import { byId, keepText, recallText } from "./dom.js";

const SOUND_STORE = "babyrobot:sound";
const TONE = 0.12; // Seconds of a tone.
const LOUDNESS = 0.15;
const [GOOD, BAD] = [
  [523, 659, 784, 1047],
  [262, 196],
];
/** The tones of events and ends, in hertz. */
const TONES = {
  exit: GOOD,
  good: GOOD,
  hit: BAD,
  over: BAD,
  time: BAD,
  bump: [110],
  bounce: [110],
  skid: [330, 262],
  carried: [330, 440],
};

/** @type {AudioContext | null} */
let audio = null;

/** Offer sounds, as they were chosen before. */
export function offerSounds() {
  byId("sound").checked = recallText(SOUND_STORE) === "on";
  byId("sound").addEventListener("change", ({ target }) => {
    keepText(SOUND_STORE, target.checked ? "on" : "off");
    sound("exit");
  });
}

/** Let an event, or an end, be heard. */
export function sound(event) {
  const tones = TONES[event];
  if (tones === undefined || !byId("sound").checked) return;
  audio ??= new AudioContext();
  tones.forEach((pitch, at) => {
    const begin = audio.currentTime + at * TONE;
    const tone = new OscillatorNode(audio, { type: "triangle", frequency: pitch });
    const volume = new GainNode(audio, { gain: LOUDNESS });
    volume.gain.setTargetAtTime(0, begin + TONE / 2, TONE / 4);
    tone.connect(volume).connect(audio.destination);
    tone.start(begin);
    tone.stop(begin + 2 * TONE);
  });
}
