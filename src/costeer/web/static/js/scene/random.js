/** Numbers that look random and are the same for everyone who drives there. */

/** A number in [0, 1) that belongs to two whole numbers. */
export function hash(a, b = 0) {
  let h = Math.imul(a | 0, 0x9e3779b1) ^ Math.imul((b | 0) + 0x7f4a7c15, 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  h = Math.imul(h ^ (h >>> 12), 0x297a2d39);
  return ((h ^ (h >>> 15)) >>> 0) / 4294967296;
}

/** A stream of such numbers. */
export function stream(seed) {
  let n = 0;
  return () => hash(seed, n++);
}
