/**
 * Marks: windsocks where gusts begin, and lines where zones begin and end.
 *
 * Who drives for a study sees no zones: they are of the measures, not of the road.
 */

import { CylinderGeometry, Group, Matrix4 } from "../../vendor/three.module.js";
import { box, coloured, merged, quad } from "./geometry.js";

/** A mark is drawn from so far ahead until it is so far behind the car [m]. */
const SEEN_AHEAD = 700;
const SEEN_BEHIND = 100;

const POLE = 4.5;
const STRIPES = ["#d8452a", "#f3f1ea", "#d8452a", "#f3f1ea", "#d8452a"];
const STRIPE = 0.45;
const LINE_COLOURS = { start: "#2fa05a", end: "#d08a1e" };
const LINE_DEPTH = 0.5;
/** Above the asphalt, so that both do not flicker [m]. */
const LINE_HEIGHT = 0.02;

/** A striped sleeve on a pole, blown to a side: +1 left, -1 right. */
function windsock(side) {
  const lying = new Matrix4().makeTranslation(0, 0, POLE);
  const stripes = STRIPES.map((colour, n) => {
    const radius = (k) => 0.32 - 0.035 * k;
    const sleeve = new CylinderGeometry(radius(n + 1), radius(n), STRIPE, 10)
      .translate(0, 0.15 + STRIPE * (n + 0.5), 0);
    if (side < 0) sleeve.applyMatrix4(new Matrix4().makeRotationZ(Math.PI));
    return coloured(sleeve.applyMatrix4(lying), colour);
  });
  return merged([box([0.09, 0.09, POLE + 0.3], [0, 0, POLE / 2], "#d9dcdd"), ...stripes]);
}

/** A line across the carriageway. */
function line(layout, colour) {
  const [right, left] = [layout.outerPaved, layout.innerPaved].sort((a, b) => a - b);
  const half = LINE_DEPTH / 2;
  const corners = [[-half, left], [-half, right], [half, right], [half, left]];
  return quad(corners.map(([x, y]) => [x, y, LINE_HEIGHT]), colour);
}

/** Place along the road [m], place across [m] and geometry of each mark. */
function marksOf(layout, hello) {
  const { events = [], zones = [] } = hello.scenario ?? {};
  const beside = layout.outerBarrier + layout.outer * 1.4;
  const gusts = events
    .filter(([kind]) => kind === "gust")
    .map(([, from, , side]) => [from, beside, windsock(side === "right" ? -1 : 1)]);
  const ends = zones.flatMap(([, from, to]) => [[from, "start"], [to, "end"]]);
  const lines = ends.map(([place, end]) => [place, 0, line(layout, LINE_COLOURS[end])]);
  return hello.role === "driver" ? gusts : [...gusts, ...lines];
}

/**
 * @returns {{group: Group, update: (position: number) => void}} as landmarks are
 */
export function buildMarks(workshop, course, layout, hello) {
  const group = new Group();
  const marks = marksOf(layout, hello).map(([place, y, geometry]) => {
    const mesh = workshop.mesh(geometry);
    group.add(mesh);
    return { place, y, mesh };
  });
  const update = (position) => {
    for (const { place, y, mesh } of marks) {
      const ahead = place - position;
      mesh.visible = ahead < SEEN_AHEAD && ahead > -SEEN_BEHIND;
      if (mesh.visible) course.put(mesh, ahead, y);
    }
  };
  return { group, update };
}
