// Sounds: short tones for what happens, once they are switched on.

import { byId, keepText, recallText } from "./dom.js";

const SOUND_STORE = "babyrobot:sound";
const TONE = 0.12; // Seconds.
/** The tones of ends and events, in hertz. */
const TONES = {
  won: [523, 659, 784, 1047],
  lost: [262, 196],
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
    sound("won");
  });
}

/** Let an end, or an event, be heard. */
export function sound(event) {
  if (!(event in TONES) || !byId("sound").checked) return;
  audio ??= new AudioContext();
  TONES[event].forEach((frequency, at) => {
    const begin = audio.currentTime + at * TONE;
    const tone = new OscillatorNode(audio, { type: "triangle", frequency });
    const volume = new GainNode(audio, { gain: 0.15 });
    volume.gain.setTargetAtTime(0, begin + TONE / 2, TONE / 4);
    tone.connect(volume).connect(audio.destination);
    tone.start(begin);
    tone.stop(begin + 2 * TONE);
  });
}
