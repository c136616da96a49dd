/**
 * Layout: where things lie across the road [m], y positive to the left.
 *
 * The outer side has the wide shoulder, the inner one the median; under left-hand traffic
 * the outer side is the left. A barrier stands on both sides where the car is stopped: a
 * shoulder's width beside the outer lines.
 */

/** How far the scenery reaches along the road, from the car [m]. */
export const BEHIND = 300;
export const AHEAD = 1500;

/** Length after which the fixed scenery repeats [m]. */
export const PERIOD = 100;

/** More than this of a shoulder is grass [m]. */
const MOST_PAVED = 3;
const MEDIAN = 3.2;

/** How far the foot of a barrier stands behind its face [m]. */
export const BARRIER_DEPTH = 0.07;

/**
 * @param {{lane_width: number, num_lanes: number, overtaking_side: number}} road
 * @param {{shoulder?: number, rumble_strip?: boolean}} scenery
 */
export function layoutOf(road, { shoulder = 2.5, rumble_strip: hasStrip = true } = {}) {
  const lane = road.lane_width;
  const outer = road.overtaking_side > 0 ? -1 : 1;
  const leftmost = lane / 2;
  const rightmost = leftmost - road.num_lanes * lane;
  const [outerEdge, innerEdge] = outer > 0 ? [leftmost, rightmost] : [rightmost, leftmost];
  const paved = Math.min(shoulder, MOST_PAVED);
  const outerPaved = outerEdge + outer * paved;
  const innerPaved = innerEdge - outer * paved;
  const innerBarrier = innerEdge - outer * shoulder;
  const opposite = innerBarrier - outer * (MEDIAN + shoulder - paved);
  const width = Math.abs(outerPaved - innerPaved);
  return {
    lane,
    numLanes: road.num_lanes,
    outer,
    outerEdge,
    innerEdge,
    outerPaved,
    innerPaved,
    /** Faces of the barriers. */
    outerBarrier: outerEdge + outer * shoulder,
    innerBarrier,
    /** How much further than the pavement the barrier stands. */
    verge: shoulder - paved,
    hasStrip,
    /** Where the carriageway of the other direction begins and ends. */
    opposite,
    oppositeFar: opposite - outer * width,
    width,
    /** Middle of a lane; lanes count from the right. */
    centre: (number) => (number - (road.num_lanes - 1)) * lane,
  };
}
