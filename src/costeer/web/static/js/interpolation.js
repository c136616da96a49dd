/**
 * Interpolation: the state at the time that is on show.
 *
 * Frames come at 60 Hz and not quite evenly, the display has a rate of its own. The page
 * shows the world a little more than one frame late, so that it lies between two frames
 * that are there. Where frames are late it goes on by at most 50 ms, then stands still.
 */

/** Furthest that a state is extrapolated [s]. */
export const LONGEST_EXTRAPOLATION = 0.05;

/** Share of a newly seen longer way that is believed, per frame [-]. */
const DRIFT = 0.002;

/** Frames that are kept. */
const KEPT = 32;

export class StateBuffer {
  /**
   * @param {import("./frames.js").Columns} columns
   * @param {number} rate of the frames [Hz]
   */
  constructor(columns, rate) {
    this.columns = columns;
    this.delay = 1.25 / rate;
    this.frames = [];
    this.out = new Float64Array(columns.names.length);
    /** Page clock minus the frames' clock, along the quickest way seen [s]. */
    this.offset = Number.NaN;
  }

  /** The time that frames are laid out by: the host's clock, else the simulation's. */
  instant(frame) {
    const sent = this.columns.value(frame, "sent_time");
    return Number.isFinite(sent) ? sent : this.columns.value(frame, "time");
  }

  /**
   * Add a frame.
   * @param {Float64Array} frame
   * @param {number} received page clock at its receipt [s]
   */
  push(frame, received) {
    const instant = this.instant(frame);
    const newest = this.frames.at(-1);
    if (newest && instant < newest.instant) this.restart();
    if (newest && instant === newest.instant) this.frames.pop();
    const place = this.evenInstant(frame, instant);
    this.frames.push({ frame, instant, place });
    if (this.frames.length > KEPT) this.frames.shift();
    const way = received - instant;
    const first = !(Math.abs(way - this.offset) < 1);
    this.offset = first || way < this.offset ? way : this.offset + DRIFT * (way - this.offset);
  }

  /**
   * Instant of a frame on an even grid. While the simulation runs its steps are exactly
   * even, the instants of sending are not: motion laid out by them would tremble.
   */
  evenInstant(frame, instant) {
    const newest = this.frames.at(-1);
    if (!newest) return instant;
    const step = this.columns.value(frame, "time") - this.columns.value(newest.frame, "time");
    if (!(step > 0 && step < 0.1)) return instant;
    const place = newest.place + step;
    return Math.abs(instant - place) > 0.03 ? instant : place + 0.02 * (instant - place);
  }

  /** Forget all frames, as after a new start of the server. */
  restart() {
    this.frames = [];
    this.offset = Number.NaN;
  }

  /**
   * The state to show.
   * @param {number} time page clock [s]
   * @returns {Float64Array|null} valid until the next call; null before the first frame
   */
  at(time) {
    const { frames } = this;
    if (frames.length === 0) return null;
    if (frames.length === 1) return frames[0].frame;
    const wanted = time - this.offset - this.delay;
    let n = frames.length - 1;
    while (n > 1 && frames[n - 1].place > wanted) n--;
    const [before, after] = [frames[n - 1], frames[n]];
    const latest = after.place + LONGEST_EXTRAPOLATION;
    const shown = Math.min(Math.max(wanted, before.place), latest);
    const span = Math.max(after.place - before.place, 1e-6);
    // A pause or a gap must not turn into speed.
    const fraction = span > 0.1 ? 1 : (shown - before.place) / span;
    return this.columns.blend(before.frame, after.frame, fraction, this.out);
  }
}
