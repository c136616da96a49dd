/**
 * Latency: how old is what the page knows, and how soon does it know what was done.
 */

import { now } from "./clock.js";

/** Values kept for the figures on show. */
const KEPT = 600;

/** A list that forgets its oldest values. */
class Recent {
  constructor() {
    this.values = [];
  }

  add(value) {
    this.values.push(value);
    if (this.values.length > KEPT) this.values.shift();
  }

  /** A quantile, NaN without values. */
  quantile(share) {
    if (this.values.length === 0) return Number.NaN;
    const sorted = [...this.values].sort((a, b) => a - b);
    return sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)];
  }

  summary() {
    return { count: this.values.length, p50: this.quantile(0.5), p95: this.quantile(0.95) };
  }
}

export class Latency {
  constructor() {
    /** Input sent to the state that holds it received [ms]. */
    this.input = new Recent();
    /** Reading of the wheel to its receipt in the page [ms]. */
    this.wheel = new Recent();
    this.roundTrip = new Recent();
    /** Whether the server is told the wheel's latency, else that of the page's input. */
    this.ofWheel = false;
    this.sent = new Map();
    this.unsent = [];
    this.bestRoundTrip = Number.POSITIVE_INFINITY;
    /** Server clock minus page clock [s]. */
    this.serverOffset = Number.NaN;
  }

  inputSent(sequence) {
    this.sent.set(sequence, now());
    // Echoes that never come must not pile up.
    if (this.sent.size > 200) this.sent.delete(this.sent.keys().next().value);
  }

  /** Note a frame: which input it holds, and how old its reading of the wheel is. */
  frameReceived(columns, frame, received) {
    const applied = columns.value(frame, "input_sequence");
    for (const [sequence, sent] of this.sent) {
      if (!(sequence <= applied)) break;
      this.sent.delete(sequence);
      // Inputs between two control steps are told together: only the newest was applied.
      if (sequence === applied) this.note(this.input, (received - sent) * 1000);
    }
    const read = columns.value(frame, "wheel_time");
    const age = (received + this.serverOffset - read) * 1000;
    if (Number.isFinite(age)) this.note(this.wheel, age);
  }

  note(list, value) {
    list.add(value);
    if (list === (this.ofWheel ? this.wheel : this.input)) this.unsent.push(value);
  }

  /** Values since the last call, for the server [ms]. */
  takeUnsent() {
    const values = this.unsent;
    this.unsent = [];
    return values;
  }

  /** A ping came back: the quickest one tells the clocks' difference best. */
  pong(message, received) {
    const sent = message.t / 1000;
    const trip = received - sent;
    if (!(trip >= 0)) return;
    this.roundTrip.add(trip * 1000);
    this.bestRoundTrip *= 1.01;
    if (trip > this.bestRoundTrip) return;
    this.bestRoundTrip = trip;
    this.serverOffset = message.server_time - (sent + received) / 2;
  }

  summary() {
    return {
      input: this.input.summary(),
      wheel: this.wheel.summary(),
      roundTrip: this.roundTrip.summary(),
    };
  }
}

/** Frames per second, over the last second. */
export class FrameCounter {
  constructor() {
    this.times = [];
  }

  tick(time) {
    this.times.push(time);
    while (this.times[0] < time - 2) this.times.shift();
  }

  get fps() {
    const span = this.times.at(-1) - this.times[0];
    return span > 0 ? (this.times.length - 1) / span : 0;
  }
}
