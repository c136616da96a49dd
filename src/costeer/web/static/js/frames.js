/**
 * Frames: rows of numbers whose columns have names.
 *
 * A frame is a Float64Array; `Columns` knows which number is what.
 */

/** A car that is further off than this from its last place is another one [m]. */
const JUMP = 15;

/** Columns that say where another car is. */
const OF_CARS = /^(lead_distance|car_\d+_position)$/;

export class Columns {
  /**
   * @param {string[]} names
   * @param {string[]} stepped those that jump: between two frames the newer one holds
   */
  constructor(names, stepped) {
    this.names = names;
    this.index = new Map(names.map((name, place) => [name, place]));
    this.stepped = names.map((name) => stepped.includes(name));
    this.jumping = names.map((name) => OF_CARS.test(name));
  }

  /** The value of a column, NaN where the frame does not have it. */
  value(frame, name) {
    const place = this.index.get(name);
    return place === undefined ? Number.NaN : frame[place];
  }

  /** The value of a column, or another where it is not a number. */
  finite(frame, name, otherwise = 0) {
    const value = this.value(frame, name);
    return Number.isFinite(value) ? value : otherwise;
  }

  /** As `value`, but no gain where nothing assists: what fades there gives no torque. */
  shown(frame, name) {
    const isUnassisted = this.value(frame, "strength_factor") === 0;
    return name === "haptic_gain" && isUnassisted ? Number.NaN : this.value(frame, name);
  }

  /** The frame as an object by names. */
  named(frame) {
    return Object.fromEntries(this.names.map((name, place) => [name, frame[place]]));
  }

  /** Frames of a message or a file: views into its buffer, nothing is copied. */
  split(buffer) {
    const width = this.names.length;
    const count = Math.floor(buffer.byteLength / (8 * width));
    return Array.from({ length: count }, (_, n) => new Float64Array(buffer, 8 * width * n, width));
  }

  /**
   * State between two frames.
   * @param {Float64Array} before
   * @param {Float64Array} after
   * @param {number} fraction 0 at `before`, 1 at `after`, more to extrapolate
   * @param {Float64Array} out is overwritten
   */
  blend(before, after, fraction, out) {
    for (let n = 0; n < out.length; n++) {
      const [a, b] = [before[n], after[n]];
      const jumps = this.stepped[n] || (this.jumping[n] && Math.abs(b - a) > JUMP);
      const mixed = a + (b - a) * fraction;
      out[n] = jumps || Number.isNaN(mixed) ? b : mixed;
    }
    return out;
  }
}
