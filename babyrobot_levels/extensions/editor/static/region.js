// Regions: what a rectangle of cells has, copied, and stamped elsewhere.

import { COMMON } from "../../../render/static/common.js";
import { element } from "../../../render/static/paint.js";
import { cornersOf } from "./spots.js";

/** The axes along which what is copied can be mirrored. */
export const MIRRORS = [
  { axis: "x", text: "Mirror ↔", key: "H" },
  { axis: "y", text: "Mirror ↕", key: "Y" },
];

/** Mirror what is copied along an axis, or no longer. */
export function mirror(editor, axis) {
  const { mirror: axes } = editor.options.stamp;
  const flipped = MIRRORS.filter((each) => axes.includes(each.axis) !== (each.axis === axis));
  editor.choose("stamp", { mirror: flipped.map((each) => each.axis).join("") });
}

/** Copy the region that some cells span: the tool then stamps it. */
export async function copy(editor, cells) {
  const picture = partOf(editor, cells);
  const { size, error } = await editor.ask({ do: "lift", cells: cornersOf(cells) });
  if (size === undefined) return editor.say(error ?? "", "refused");
  editor.region = { size, picture };
  editor.choose("stamp", { mirror: "" });
  return editor.say(`Copied ${size.join(" × ")}: click where it goes.`);
}

/** Return the part of the picture that some cells span, as it is now. */
function partOf({ game, picture }, cells) {
  const [[left, top], [right, bottom]] = cornersOf(cells);
  const [x, y] = game.corner(left, top);
  const [width, height] = [right - left + 1, bottom - top + 1].map((count) => count * COMMON.cell);
  const part = picture.svg.cloneNode(true);
  for (const each of part.querySelectorAll(".layers, #robot")) each.remove();
  return element("svg", { viewBox: `${x} ${y} ${width} ${height}`, width, height }, ...part.childNodes);
}

/** Return what is copied as it will be seen with its first cell at a corner. */
export function stamped({ picture }, { mirror: axes }, [x, y]) {
  const [width, height] = ["width", "height"].map((name) => Number(picture.getAttribute(name)));
  const [across, down] = MIRRORS.map(({ axis }) => axes.includes(axis));
  const turn = `scale(${across ? -1 : 1} ${down ? -1 : 1})`;
  return element(
    "g",
    { class: "stamped", transform: `translate(${x + across * width} ${y + down * height}) ${turn}` },
    picture,
  );
}
