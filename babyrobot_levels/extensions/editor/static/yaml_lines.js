// The lines of a level file as elements, coloured as YAML.

import { html } from "../../../render/static/dom.js";

const TOKENS =
  /(?<string>"(?:[^"\\]|\\.)*"|'(?:[^']|'')*')|(?<comment>(?<=^|\s)#.*)|(?<key>[\w-]+(?=:(?:\s|$)))|(?<number>(?<![\w.#-])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]))/g;
const BLOCK = /^( *)(?:- +)*(?:[\w-]+: +)?[|>][-+\d]*(?:\s+#.*)?$/;

/**
 * Return for each line whether it belongs to a text that is written as it is, such as a drawing.
 *
 * @param {string[]} lines
 * @returns {boolean[]}
 */
export function plainLines(lines) {
  let indent = null;
  return lines.map((line) => {
    const isInside = indent !== null && (line.trim() === "" || line.search(/\S/) > indent);
    if (!isInside) indent = BLOCK.exec(line)?.[1].length ?? null;
    return isInside;
  });
}

/**
 * Return a line as an element; `marks` are places in it, from a column to another, with a class.
 *
 * @param {string} line
 * @param {Mark[]} marks
 * @param {boolean} isPlain
 */
export function lineElement(line, marks, isPlain) {
  const spans = marks.map(({ from, to, kind }) => ({ from, to, kind }));
  if (!isPlain) {
    for (const { index, 0: found, groups } of line.matchAll(TOKENS)) {
      const kind = Object.keys(groups).find((name) => groups[name] !== undefined);
      spans.push({ from: index, to: index + found.length, kind });
    }
  }
  const cuts = [0, line.length, ...spans.flatMap(({ from, to }) => [from, to])];
  const places = [...new Set(cuts)].sort((one, other) => one - other);
  const parts = places.slice(1).map((to, index) => {
    const from = places[index];
    const kinds = spans.filter((span) => span.from <= from && to <= span.to).map(({ kind }) => kind);
    // A mark behind the end of the line shows as a space.
    const part = line.slice(from, to).padEnd(to - from);
    return kinds.length === 0 ? part : html("span", { class: kinds.join(" ") }, part);
  });
  return html("div", { class: "line" }, ...parts, "\n");
}

/**
 * Return the places of a finding in the text: where in its first line.
 *
 * @param {Finding} finding
 * @param {string[]} lines
 * @returns {Mark}
 */
export function markOf({ line, column, end_line, end_column, severity }, lines) {
  const content = lines[line - 1] ?? "";
  // Python counts characters, JavaScript their halves.
  const units = (count) => [...content].slice(0, count).join("").length;
  const from = units(column - 1);
  const to = end_line === line ? units(end_column - 1) : content.trimEnd().length;
  return { from, to: Math.max(from + 1, to), kind: `mark ${severity}` };
}
