/**
 * Interior: what frames the driver's view, in axes with the eye at the origin [m].
 *
 * `middle` is where the car's middle lies across: the driver sits beside it.
 */

import { CylinderGeometry, Matrix4, Shape, Vector3 } from "../../vendor/three.module.js";
import { box, coloured, drawnOut, merged, outline, quad } from "./geometry.js";

const SOFT = "#454a4f";
const HARD = "#33373b";
const DARK = "#16191c";
const LINING = "#7d7b75";
const SHADE = "#5e5c57";

/** Half the width between the pillars' feet, their heads, and the doors' sills. */
const FOOT = 0.8;
const HEAD = 0.66;
const SILL = 0.79;

/** Darken the lower and the hidden parts: light comes through the windows. */
export function softlyLit(geometry, floor = -0.62, top = -0.24) {
  const { position, color } = geometry.attributes;
  for (let n = 0; n < color.count; n++) {
    const share = Math.min(1, Math.max(0, (position.getZ(n) - floor) / (top - floor)));
    const light = 0.42 + 0.58 * share ** 1.3;
    color.setXYZ(n, color.getX(n) * light, color.getY(n) * light, color.getZ(n) * light);
  }
  return geometry;
}

/** A face between two lines of equally many points, seen from the driver. */
function sheet(first, second, colour) {
  const faces = first.slice(1).map((point, n) => quad([first[n], point, second[n + 1], second[n]], colour));
  return merged(faces.flatMap((face) => [face, turned(face)]));
}

/** The same face seen from behind. */
function turned(face) {
  const copy = face.clone();
  for (const attribute of Object.values(copy.attributes)) {
    const { array, itemSize } = attribute;
    for (let n = 0; n < attribute.count; n += 3) {
      for (let k = 0; k < itemSize; k++) {
        const [a, b] = [(n + 1) * itemSize + k, (n + 2) * itemSize + k];
        [array[a], array[b]] = [array[b], array[a]];
      }
    }
  }
  return copy;
}

/** Board below the windscreen, from door to door: a soft pad above, hard below. */
function board(middle) {
  const pad = [
    [0.94, -0.45], [0.925, -0.385], [0.95, -0.352], [1.02, -0.34], [1.3, -0.336], [1.36, -0.35], [1.36, -0.45],
  ];
  const below = [[0.99, -0.8], [0.955, -0.55], [0.965, -0.445], [1.36, -0.445], [1.36, -0.8]];
  const across = (side, colour) => coloured(drawnOut(outline(side), 1.62, 0.01), colour).translate(0, middle, 0);
  return [across(pad, SOFT), across(below, HARD), box([0.012, 1.5, 0.012], [0.945, middle, -0.435], "#8a9299")];
}

/** Hood over the instruments, rounded, open to the driver. */
function binnacle() {
  const shape = new Shape();
  const arch = (inset) => [
    [-0.17 + inset, -0.32], [-0.165 + inset, -0.19], [-0.15 + inset, -0.145 - inset],
    [-0.09, -0.128 - inset], [0.09, -0.128 - inset], [0.15 - inset, -0.145 - inset],
    [0.165 - inset, -0.19], [0.17 - inset, -0.32],
  ];
  const points = [...arch(0), ...arch(0.013).reverse()];
  points.forEach(([a, b], n) => (n === 0 ? shape.moveTo(a, b) : shape.lineTo(a, b)));
  const hood = drawnOut(shape, 0.16, 0.003).applyMatrix4(new Matrix4().makeRotationZ(-Math.PI / 2));
  return [
    coloured(hood.translate(1.0, 0, 0), HARD), box([0.02, 0.33, 0.2], [1.075, 0, -0.225], DARK),
  ];
}

/** A vent: a frame with slats. */
function vent(y) {
  const slats = [-0.024, -0.008, 0.008, 0.024].map((z) => box([0.008, 0.13, 0.004], [0.926, y, -0.405 + z], "#3d4348"));
  return [box([0.02, 0.15, 0.078], [0.935, y, -0.405], "#0c0e10"), ...slats];
}

/** Vents, the screen of the radio, a line of buttons. */
function consoleParts(middle, inner) {
  const buttons = [-2, -1, 0, 1, 2].map((n) =>
    box([0.012, 0.03, 0.014], [0.948, middle + n * 0.042, -0.51], "#454b50"));
  return [
    ...vent(middle + 0.13), ...vent(middle - 0.13), ...vent(middle + inner * 0.68), ...vent(-inner * 0.3),
    box([0.015, 0.25, 0.13], [0.925, middle, -0.285], DARK),
    box([0.004, 0.232, 0.112], [0.916, middle, -0.285], "#1b3040"), ...buttons,
  ];
}

/** A beam with a flat section between two points. */
function beam(from, to, [wide, deep], colour) {
  const [start, end] = [new Vector3(...from), new Vector3(...to)];
  const middle = start.clone().add(end).multiplyScalar(0.5);
  const turn = new Matrix4().lookAt(end, start, new Vector3(1, 0, 0));
  return box([wide, deep, start.distanceTo(end)], middle.toArray(), colour, turn);
}

/** Edge of the roof above the windscreen: an arch from pillar to pillar. */
function roofEdge(middle) {
  return Array.from({ length: 17 }, (_, n) => {
    const v = 1 - n / 8;
    return [0.7 - 0.15 * v * v, middle + HEAD * v, 0.162 + 0.036 * v * v];
  });
}

/** Roof, pillars and doors. Pillars stand on the board and carry the roof. */
function frameParts(middle) {
  const edge = roofEdge(middle);
  const raised = (line, x, z) => line.map((point) => [point[0] + x, point[1], point[2] + z]);
  const parts = [
    sheet(edge, raised(edge, -0.03, 0.028), SHADE),
    sheet(raised(edge, -0.03, 0.028), edge.map(([, y]) => [-0.9, y, 0.27]), LINING),
  ];
  for (const side of [1, -1]) {
    const foot = [1.27, middle + side * FOOT, -0.36];
    const head = [0.55, middle + side * HEAD, 0.22];
    parts.push(beam(foot, head, [0.045, 0.06], SOFT), ...door(middle, side));
    // The frame of the side window, back to the pillar behind the driver.
    parts.push(beam(head, [-0.45, middle + side * (HEAD - 0.02), 0.26], [0.05, 0.05], HARD));
    parts.push(beam([-0.45, middle + side * SILL, -0.36], [-0.5, middle + side * HEAD, 0.28], [0.05, 0.1], HARD));
  }
  return parts;
}

/** A door: sill, panel, arm rest, handle. */
function door(middle, side) {
  const at = (out) => middle + side * out;
  return [
    box([1.85, 0.07, 0.035], [0.36, at(SILL), -0.345], SOFT),
    box([1.85, 0.03, 0.5], [0.36, at(SILL + 0.02), -0.6], HARD),
    box([0.62, 0.08, 0.05], [0.32, at(SILL - 0.05), -0.5], SOFT),
    box([0.16, 0.02, 0.02], [0.72, at(SILL - 0.02), -0.42], "#9aa1a6"),
    // The triangle in which the mirror is mounted.
    box([0.16, 0.03, 0.1], [1.12, at(SILL + 0.005), -0.28], DARK),
  ];
}

/** Wipers at rest, and the black edge of the windscreen. */
function cowl(middle) {
  return [
    box([0.05, 1.5, 0.01], [1.375, middle, -0.335], "#0b0c0d"),
    beam([1.39, middle + 0.6, -0.318], [1.4, middle + 0.02, -0.302], [0.01, 0.01], "#0b0c0d"),
    beam([1.39, middle - 0.02, -0.318], [1.4, middle - 0.6, -0.302], [0.01, 0.01], "#0b0c0d"),
  ];
}

/** Levers of indicator and wiper behind the wheel. */
function levers() {
  return [1, -1].map((side) => {
    const lever = new CylinderGeometry(0.008, 0.006, 0.13, 10);
    lever.applyMatrix4(new Matrix4().makeRotationZ(side * 0.12));
    return coloured(lever.translate(0.9, side * 0.125, -0.235), DARK);
  });
}

/** All of it that stands still and is not glossy. */
export function interiorParts(middle, inner) {
  const lower = merged([...board(middle), ...consoleParts(middle, inner), ...binnacle(), ...levers()]);
  const around = merged(frameParts(middle));
  return merged([softlyLit(lower), softlyLit(around, -0.9, 0.1), ...cowl(middle)]);
}
