/**
 * Strip: the signals of the last 20 s while driving.
 */

import { Charts, DRAWN, drawable } from "./charts.js";

/** Time on show [s], and between two points and two paintings of it. */
const SPAN = 20;
const SPACING = 1 / 30;
const REFRESH = 0.12;

export class Strip {
  /** @param {HTMLElement} parent */
  constructor(parent) {
    this.parent = parent;
    this.times = [];
    this.series = Object.fromEntries(DRAWN.map((name) => [name, []]));
    this.painted = 0;
    this.charts = null;
  }

  get isShown() {
    return !this.parent.hidden;
  }

  set isShown(isShown) {
    this.parent.hidden = !isShown;
  }

  /** Take over a frame; frames of a standing clock add nothing. */
  push(columns, frame) {
    const time = columns.value(frame, "time");
    const newest = this.times.at(-1) ?? Number.NEGATIVE_INFINITY;
    if (time < newest) this.clear();
    else if (time - newest < SPACING * 0.9) return;
    this.times.push(time);
    for (const name of DRAWN) this.series[name].push(drawable(columns.shown(frame, name)));
    const old = this.times.findIndex((one) => one >= time - SPAN - 1);
    if (old > 60) for (const list of [this.times, ...Object.values(this.series)]) list.splice(0, old);
  }

  clear() {
    for (const list of [this.times, ...Object.values(this.series)]) list.length = 0;
  }

  /** Paint, a few times a second. */
  paint(now) {
    if (!this.isShown || now - this.painted < REFRESH) return;
    this.painted = now;
    this.charts ??= new Charts(this.parent, () => {
      const end = Math.max(this.times.at(-1) ?? 0, SPAN);
      return [end - SPAN, end];
    });
    this.charts.show(this.times, this.series);
  }
}
