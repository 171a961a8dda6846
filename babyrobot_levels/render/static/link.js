// Links: a level behind the `#` of the page's address, as a share code and a part to play.

/** Return the level that a fragment holds; null where it is none of ours. */
async function linkedLevel(fragment) {
  if (!/^#\s*brl[0-9]/i.test(fragment)) return null;
  const [code, play] = decoded(fragment.slice(1)).replace(/\s/g, "").split("~");
  needVersion(/^brl([0-9]+)/i.exec(code)[1], COMMON.code_version);
  if (play === undefined) {
    throw new LinkFault(
      "This link holds a share code only, without what a page needs to play the level. " +
      "`babyrobot share LEVEL --link ADDRESS` makes a link that plays.");
  }
  const parts = /^([0-9]+)\.([0-9]+)\.(.*)$/.exec(play);
  if (parts === null) throw new LinkFault("This link is cut off or damaged.");
  const [, version, length, body] = parts;
  needVersion(version, COMMON.play_version);
  if (body.length < Number(length)) {
    throw new LinkFault(
      `This link is cut off: its last ${Number(length) - body.length} characters are missing.`);
  }
  const bytes = bytesOf(body);
  if (body.length > Number(length) || bytes === null || bytes.length < 4) {
    throw new LinkFault("This link is damaged.");
  }
  const packed = bytes.subarray(4);
  const letters = new TextEncoder().encode(code.replace(/^brl/i, "brl"));
  if (checksum(packed, checksum(letters)) !== new DataView(bytes.buffer).getUint32(0)) {
    throw new LinkFault("This link is damaged: its checksum is wrong.");
  }
  const told = new TextDecoder().decode(await unpacked(packed));
  let data;
  try {
    data = JSON.parse(told);
  } catch {
    throw new LinkFault(NOT_A_LEVEL);
  }
  return checked(data);
}

function decoded(fragment) {
  try {
    return decodeURIComponent(fragment);
  } catch {
    return fragment;
  }
}

function needVersion(version, ours) {
  if (Number(version) === ours) return;
  throw new LinkFault(
    `This link is of version ${Number(version)}, and this page reads version ${ours}. ` +
    "A page made by the babyrobot-levels that made the link plays it.");
}

/** Return the bytes of base64url; null where it is none. */
function bytesOf(body) {
  if (!/^[A-Za-z0-9_-]*$/.test(body) || body.length % 4 === 1) return null;
  const letters = atob(body.replace(/-/g, "+").replace(/_/g, "/"));
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}

/** Return the CRC-32 of bytes; `before` is that of what goes before them. */
function checksum(bytes, before = 0) {
  let rest = ~before;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; bit++) rest = (rest >>> 1) ^ (rest & 1 ? 0xedb88320 : 0);
  }
  return ~rest >>> 0;
}

/** Return what was packed, with the dictionary in a stored block before it, which is cut away. */
async function unpacked(packed) {
  if (typeof DecompressionStream === "undefined") {
    throw new LinkFault("This browser is too old to play links.");
  }
  const dictionary = new TextEncoder().encode(COMMON.dictionary);
  const size = dictionary.length;
  const head = [0, size & 255, size >> 8, ~size & 255, (~size >> 8) & 255];
  const stream = new Uint8Array([...head, ...dictionary, ...packed]);
  // Small pieces, and no next one before it is asked for: a bomb is left before it goes off.
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
  while (total <= COMMON.max_unpacked + size) {
    const { done, value } = await reader.read().catch(() => {
      throw new LinkFault("This link is damaged: it cannot be unpacked.");
    });
    if (done) return new Uint8Array(await new Blob(pieces).arrayBuffer()).subarray(size);
    pieces.push(value);
    total += value.length;
  }
  reader.cancel().catch(() => {});
  throw new LinkFault("This link is refused: it would unpack to more than any level.");
}
