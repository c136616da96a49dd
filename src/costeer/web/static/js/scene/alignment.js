/**
 * Alignment: how the road runs, as the server tells it: curvature along the centre of the
 * left lane, linear between stations. Straights, arcs and clothoids are made of it.
 */

/** Spacing of the places that are kept [m]; between two of them it is integrated anew. */
const KEPT = 10;

/** Longest stretch over which the direction is integrated in one go [m]. */
const STEP = 2.5;

export class Alignment {
  /** @param {[number, number][]} stations along the road [m] and curvature there [1/m] */
  constructor(stations = []) {
    this.isStraight = stations.every(([, bend]) => bend === 0);
    const given = stations.length > 0 ? stations : [[0, 0]];
    const first = given[0][0] > 0 ? [[0, given[0][1]], ...given] : given;
    let heading = 0;
    this.stations = first.map(([at, bend], n) => {
      const [next, nextBend] = first[n + 1] ?? [at + 1, bend];
      const station = { at, bend, slope: (nextBend - bend) / (next - at), heading };
      heading += ((bend + nextBend) / 2) * (next - at);
      return station;
    });
    /** Places at every `KEPT` metres, as far as somebody has looked. */
    this.places = [{ x: 0, y: 0 }];
  }

  before(position) {
    let [low, high] = [0, this.stations.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.stations[middle].at <= position) low = middle;
      else high = middle - 1;
    }
    const station = this.stations[low];
    return { station, beyond: Math.max(position - station.at, 0) };
  }

  /** Curvature at a place, positive to the left [1/m]. */
  curvature(position) {
    const { station, beyond } = this.before(position);
    return station.bend + station.slope * beyond;
  }

  /** Direction of the road [rad], 0 at its start. */
  heading(position) {
    const { station, beyond } = this.before(position);
    return station.heading + (station.bend + (station.slope * beyond) / 2) * beyond;
  }

  /**
   * Where the road is: x forward and y left of its start [m], and its direction [rad].
   * Behind its start it is straight.
   */
  place(position) {
    const heading = this.heading(position);
    if (this.isStraight || position <= 0) return { x: position, y: 0, heading };
    const number = Math.floor(position / KEPT);
    for (let n = this.places.length; n <= number; n++) {
      this.places.push(this.gone(this.places[n - 1], (n - 1) * KEPT, n * KEPT));
    }
    return { ...this.gone(this.places[number], number * KEPT, position), heading };
  }

  /** Where one is at `to` after having been somewhere at `from`: Simpson's rule. */
  gone({ x, y }, from, to) {
    const count = Math.max(1, Math.ceil((to - from) / STEP));
    const step = (to - from) / count;
    const sum = { x, y };
    for (let n = 0; n < count; n++) {
      const start = from + n * step;
      for (const [share, weight] of [[0, 1], [0.5, 4], [1, 1]]) {
        const heading = this.heading(start + share * step);
        sum.x += (weight * step * Math.cos(heading)) / 6;
        sum.y += (weight * step * Math.sin(heading)) / 6;
      }
    }
    return sum;
  }
}
