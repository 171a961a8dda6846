// Links: a level after the `#` of the page's address, as a share code and a play part.

import { decoded } from "./address.js";
import { checked, LinkError, NOT_A_LEVEL, need } from "./checks.js";
import { COMMON } from "./common.js";
import { checksum } from "./play.js";

/**
 * Return the level in a fragment; null if the fragment is not a level link.
 *
 * @param {string} fragment
 * @returns {Promise<LevelData | null>}
 */
export async function linkedLevel(fragment) {
  if (!/^#\s*brl[0-9]/i.test(fragment)) return null;
  const [code, play] = decoded(fragment.slice(1)).replace(/\s/g, "").split("&")[0].split("~");
  needVersion(/^brl([0-9]+)/i.exec(code)[1], COMMON.code_versions);
  if (play === undefined) {
    throw new LinkError(
      "This link contains only a share code, which a page cannot play. " +
        "`babyrobot share LEVEL --link ADDRESS` makes a link that can be played.",
    );
  }
  const parts = /^([0-9]+)\.([0-9]+)\.(.*)$/.exec(play);
  if (parts === null) throw new LinkError("This link is cut off or damaged.");
  const [, version, length, body] = parts;
  needVersion(version, COMMON.play_versions);
  if (body.length < Number(length)) {
    throw new LinkError(`This link is cut off: its last ${Number(length) - body.length} characters are missing.`);
  }
  const bytes = bytesOf(body);
  if (body.length > Number(length) || bytes === null || bytes.length < 4) {
    throw new LinkError("This link is damaged.");
  }
  const packed = bytes.subarray(4);
  const letters = code.replace(/^brl/i, "brl");
  if (checksum(packed, checksum(new TextEncoder().encode(letters))) !== new DataView(bytes.buffer).getUint32(0)) {
    throw new LinkError("This link is damaged: its checksum is wrong.");
  }
  const content = new TextDecoder().decode(await unpacked(packed));
  let data;
  try {
    data = JSON.parse(content);
  } catch {
    throw new LinkError(NOT_A_LEVEL);
  }
  // Only a page that was made for an agent, or a sight, has one.
  need(data?.agent === undefined && data?.sight === undefined);
  const level = checked(data);
  level.code ??= letters;
  return level;
}

/** @param {string} version @param {number[]} ours */
function needVersion(version, ours) {
  if (ours.includes(Number(version))) return;
  const known = `version${ours.length > 1 ? "s" : ""} ${ours.join(" and ")}`;
  throw new LinkError(
    `This link has version ${Number(version)}, but this page supports ${known}. ` +
      "Open it on a page made by the same version of babyrobot-levels.",
  );
}

/** Return the bytes of base64url; null if it is invalid. @param {string} body @returns {Uint8Array | null} */
function bytesOf(body) {
  if (!/^[A-Za-z0-9_-]*$/.test(body) || body.length % 4 === 1) return null;
  const letters = atob(body.replace(/-/g, "+").replace(/_/g, "/"));
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}

/**
 * Return decompressed bytes; the dictionary, itself compressed, goes before them as a stored block.
 *
 * @param {Uint8Array} packed
 * @returns {Promise<Uint8Array>}
 */
async function unpacked(packed) {
  if (typeof DecompressionStream === "undefined") {
    throw new LinkError("This browser is too old to open links.");
  }
  const dictionary = await inflated(bytesOf(COMMON.dictionary));
  const size = dictionary.length;
  const head = [0, size & 255, size >> 8, ~size & 255, (~size >> 8) & 255];
  const bytes = await inflated(new Uint8Array([...head, ...dictionary, ...packed]), size);
  return bytes.subarray(size);
}

/** Return bytes that are decompressed from a stream, of which some count as no content. */
async function inflated(stream, free = 0) {
  // Small pieces on demand: decompression stops as soon as the limit is exceeded.
  let at = 0;
  const source = new ReadableStream({
    pull(controller) {
      if (at >= stream.length) controller.close();
      else controller.enqueue(stream.slice(at, (at += 1024)));
    },
  });
  const reader = source.pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const pieces = [];
  let total = 0;
  while (total <= COMMON.max_unpacked + free) {
    const { done, value } = await reader.read().catch(() => {
      throw new LinkError("This link is damaged: it cannot be decompressed.");
    });
    if (done) return new Uint8Array(await new Blob(pieces).arrayBuffer());
    pieces.push(value);
    total += value.length;
  }
  reader.cancel().catch(() => {});
  throw new LinkError("This link is refused: its content is larger than any level.");
}
