/**
 * Layout: where things lie across the road [m], y positive to the left.
 *
 * The outer side has the wide shoulder, the inner one the median; under left-hand traffic
 * the outer side is the left.
 */

/** How far the scenery reaches along the road, from the car [m]. */
export const BEHIND = 300;
export const AHEAD = 1500;

/** Length after which the fixed scenery repeats [m]. */
export const PERIOD = 100;

const OUTER_SHOULDER = 2.5;
const INNER_SHOULDER = 0.75;
const MEDIAN = 3.2;

/**
 * @param {{lane_width: number, num_lanes: number, overtaking_side: number}} road
 */
export function layoutOf(road) {
  const lane = road.lane_width;
  const outer = road.overtaking_side > 0 ? -1 : 1;
  const leftmost = lane / 2;
  const rightmost = leftmost - road.num_lanes * lane;
  const [outerEdge, innerEdge] = outer > 0 ? [leftmost, rightmost] : [rightmost, leftmost];
  const outerPaved = outerEdge + outer * OUTER_SHOULDER;
  const innerPaved = innerEdge - outer * INNER_SHOULDER;
  const opposite = innerPaved - outer * MEDIAN;
  const width = Math.abs(outerPaved - innerPaved);
  return {
    lane,
    numLanes: road.num_lanes,
    outer,
    outerEdge,
    innerEdge,
    outerPaved,
    innerPaved,
    /** Where the carriageway of the other direction begins and ends. */
    opposite,
    oppositeFar: opposite - outer * width,
    width,
    /** Middle of a lane; lanes count from the right. */
    centre: (number) => (number - (road.num_lanes - 1)) * lane,
  };
}
