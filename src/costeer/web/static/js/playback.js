/**
 * Playback: where in a record the replay is, and how fast it goes.
 */

export const SPEEDS = [0.25, 0.5, 1, 2, 4];

export class Playback {
  /**
   * @param {import("./frames.js").Columns} columns
   * @param {Float64Array[]} rows in order of time
   */
  constructor(columns, rows) {
    this.columns = columns;
    this.rows = rows;
    this.times = rows.map((row) => columns.value(row, "time"));
    this.start = this.times[0] ?? 0;
    this.end = this.times.at(-1) ?? 0;
    this.time = this.start;
    this.speed = 1;
    this.isPlaying = false;
    this.out = new Float64Array(columns.names.length);
  }

  /** Number of the last row at or before a time. */
  rowAt(time) {
    let [low, high] = [0, this.times.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Let time pass [s]; at the end it stops. */
  advance(elapsed) {
    if (!this.isPlaying) return;
    this.seek(this.time + elapsed * this.speed);
    if (this.time >= this.end) this.isPlaying = false;
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
  }

  /** Play or stop; at the end it begins anew. */
  toggle() {
    if (!this.isPlaying && this.time >= this.end) this.time = this.start;
    this.isPlaying = !this.isPlaying;
  }

  /** Go some rows on, or back. */
  step(rows) {
    this.isPlaying = false;
    const row = Math.min(Math.max(this.rowAt(this.time) + rows, 0), this.rows.length - 1);
    this.time = this.times[row];
  }

  /** Next speed up (+1) or down (-1). */
  changeSpeed(direction) {
    const place = SPEEDS.indexOf(this.speed) + direction;
    this.speed = SPEEDS[Math.min(Math.max(place, 0), SPEEDS.length - 1)];
  }

  /** The state now, between two rows. */
  state() {
    const row = this.rowAt(this.time);
    const next = Math.min(row + 1, this.rows.length - 1);
    const span = this.times[next] - this.times[row];
    const fraction = span > 0 ? (this.time - this.times[row]) / span : 0;
    if (!(fraction > 0)) return this.rows[row];
    this.columns.blend(this.rows[row], this.rows[next], fraction, this.out);
    // Columns that jump hold until the next row.
    this.columns.stepped.forEach((isStepped, n) => {
      if (isStepped) this.out[n] = this.rows[row][n];
    });
    return this.out;
  }
}
