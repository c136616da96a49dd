/**
 * Pace: what a machine without a graphics card leaves out so that pictures stay frequent.
 */

/** From each level to the next less is drawn: pictures between two of mirrors, smooth edges. */
const LEVELS = [
  { mirrorsEvery: 1, isSmooth: true },
  { mirrorsEvery: 2, isSmooth: true },
  { mirrorsEvery: 4, isSmooth: true },
  { mirrorsEvery: 4, isSmooth: false },
];

/** Longest time between pictures [s], 12 a second and a little more; below the other there is room. */
const SLOW = 0.075;
const QUICK = 0.035;

/** Pictures over which it is judged, and after which more is tried again. */
const JUDGED = 20;
const PATIENT = 240;

/** Longer than that is a pause of the page, no picture [s]. */
const PAUSE = 1;

export class Pace {
  constructor() {
    this.level = 1;
    this.last = Number.NaN;
    this.spent = [];
    this.quick = 0;
  }

  /** Note a picture at a time [s]; returns what to draw of the next. */
  tick(time) {
    const took = time - this.last;
    this.last = time;
    if (took > 0 && took < PAUSE) this.judge(took);
    return LEVELS[this.level];
  }

  judge(took) {
    this.spent.push(took);
    if (this.spent.length < JUDGED) return;
    const mean = this.spent.reduce((sum, one) => sum + one, 0) / JUDGED;
    this.spent = [];
    this.quick = mean < QUICK ? this.quick + JUDGED : 0;
    if (mean > SLOW && this.level < LEVELS.length - 1) this.level += 1;
    else if (this.quick >= PATIENT && this.level > 0) [this.level, this.quick] = [this.level - 1, 0];
  }
}
