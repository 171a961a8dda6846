// NumPy's default generator (PCG64, seeded by a SeedSequence), so that a seed and the same actions
// give the same episode here and in the environments.
export class Generator {
  /** @param {string | number | bigint} seed */
  constructor(seed) {
    const [a, b, c, d] = seedWords(BigInt(seed));
    this.increment = BigInt.asUintN(128, (((c << 64n) | d) << 1n) | 1n);
    this.state = 0n;
    this.next64();
    this.state += (a << 64n) | b;
    this.next64();
    /** @type {bigint | null} */
    this.half = null;
  }

  /** What `restore` takes to draw the same numbers again. @returns {[bigint, bigint | null]} */
  get place() {
    return [this.state, this.half];
  }

  /** @param {[bigint, bigint | null]} place */
  restore([state, half]) {
    this.state = state;
    this.half = half;
  }

  next64() {
    const multiplier = 0x2360ed051fc65da44385df649fccf645n;
    this.state = BigInt.asUintN(128, this.state * multiplier + this.increment);
    const turn = this.state >> 122n;
    const mixed = BigInt.asUintN(64, (this.state >> 64n) ^ this.state);
    return BigInt.asUintN(64, (mixed >> turn) | (mixed << (64n - turn)));
  }

  next32() {
    // Each 64 bits are used twice, the lower half first.
    if (this.half !== null) {
      const kept = this.half;
      this.half = null;
      return kept;
    }
    const bits = this.next64();
    this.half = bits >> 32n;
    return BigInt.asUintN(32, bits);
  }

  /** Return a number from 0 (inclusive) to 1 (exclusive). */
  random() {
    return Number(this.next64() >> 11n) / 2 ** 53;
  }

  /** Return an integer below `count`; 1 draws nothing. @param {number} count @returns {number} */
  integer(count) {
    if (count === 1) return 0;
    const size = BigInt(count);
    const threshold = 2n ** 32n % size;
    let product = this.next32() * size;
    while (BigInt.asUintN(32, product) < threshold) product = this.next32() * size;
    return Number(product >> 32n);
  }
}

/**
 * Return the four 64-bit words that a SeedSequence generates from an integer.
 *
 * @param {bigint} seed
 * @returns {bigint[]}
 */
function seedWords(seed) {
  /** @type {(x: number, y: number) => number} */
  const times = (x, y) => Math.imul(x, y) >>> 0;
  /** @type {(x: number) => number} */
  const fold = (x) => (x ^ (x >>> 16)) >>> 0;
  const words = [];
  for (let rest = seed; rest > 0n; rest >>= 32n) words.push(Number(BigInt.asUintN(32, rest)));
  while (words.length < 4) words.push(0);

  let constant = 0x43b0d7e5;
  /** @type {(value: number) => number} */
  const hash = (value) => {
    const mixed = (value ^ constant) >>> 0;
    constant = times(constant, 0x931e8875);
    return fold(times(mixed, constant));
  };
  /** @type {(x: number, y: number) => number} */
  const mix = (x, y) => fold((times(0xca01f9dd, x) - times(0x4973f715, y)) >>> 0);
  const pool = words.slice(0, 4).map(hash);
  for (let from = 0; from < 4; from++) {
    for (let to = 0; to < 4; to++) if (from !== to) pool[to] = mix(pool[to], hash(pool[from]));
  }
  for (const word of words.slice(4)) {
    for (let to = 0; to < 4; to++) pool[to] = mix(pool[to], hash(word));
  }

  constant = 0x8b51f9dd;
  const halves = Array.from({ length: 8 }, (_, index) => {
    const mixed = (pool[index % 4] ^ constant) >>> 0;
    constant = times(constant, 0x58f38ded);
    return BigInt(fold(times(mixed, constant)));
  });
  return [0, 2, 4, 6].map((low) => halves[low] | (halves[low + 1] << 32n));
}
