// In place of `fog.js` in pages on which all is seen, which have less to load.

export function limitSight() {}

/** Nothing is hidden. */
export class Fog {
  stand() {}
}
