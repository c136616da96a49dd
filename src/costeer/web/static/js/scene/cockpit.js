/**
 * Cockpit: what the driver sees of the own car, in axes with the eye at the origin.
 *
 * `inner` is +1 where the car's middle lies to the left of the driver (right-hand drive),
 * -1 where it lies to the right.
 */

import {
  CylinderGeometry, DoubleSide, Group, Matrix4, Shape, TorusGeometry,
} from "../../vendor/three.module.js";
import { Dashboard } from "./dashboard.js";
import { EYE_OFFSET } from "./eye.js";
import { box, coloured, drawnOut, merged, outline, quad } from "./geometry.js";

const PLASTIC = "#2b2f33";
const DARK = "#1a1d20";
const TRIM = "#34393e";

/** Steering wheel: middle, radius and lean of its plane [m, rad]. */
const WHEEL = { x: 0.6, z: -0.315, radius: 0.185, lean: 0.42 };

/** Board below the windscreen, from door to door. */
function board(inner) {
  const side = [
    [0.66, -0.75], [0.63, -0.5], [0.66, -0.38], [0.72, -0.325], [0.84, -0.292], [1.42, -0.272],
    [1.42, -0.75],
  ];
  const geometry = coloured(drawnOut(outline(side), 1.7, 0.012), PLASTIC);
  return geometry.translate(0, inner * EYE_OFFSET, 0);
}

/** Arch over the instruments. */
function binnacle() {
  const shape = new Shape();
  shape.moveTo(-0.2, -0.42);
  shape.lineTo(-0.185, -0.26);
  shape.quadraticCurveTo(-0.17, -0.212, -0.1, -0.207);
  shape.lineTo(0.1, -0.207);
  shape.quadraticCurveTo(0.17, -0.212, 0.185, -0.26);
  shape.lineTo(0.2, -0.42);
  shape.lineTo(0.176, -0.42);
  shape.lineTo(0.164, -0.26);
  shape.quadraticCurveTo(0.152, -0.226, 0.1, -0.222);
  shape.lineTo(-0.1, -0.222);
  shape.quadraticCurveTo(-0.152, -0.226, -0.164, -0.26);
  shape.lineTo(-0.176, -0.42);
  const along = drawnOut(shape, 0.2);
  // The shape is seen from behind: its plane is across the car, its depth along it.
  along.applyMatrix4(new Matrix4().makeRotationZ(-Math.PI / 2));
  return coloured(along.translate(0.85, 0, 0.035), DARK);
}

/** Bonnet beyond the windscreen: a curved sheet. */
function bonnet(inner, colour) {
  const faces = [];
  const height = (u, v) => -0.305 - 0.035 * v ** 2 - 0.11 * u ** 2.2;
  const corner = (u, v) => [1.35 + 1.0 * u, inner * EYE_OFFSET + 0.78 * v * (1 - 0.1 * u), height(u, v)];
  const [rows, columns] = [8, 14];
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) {
      const [u0, u1] = [i / rows, (i + 1) / rows];
      const [v0, v1] = [1 - (2 * j) / columns, 1 - (2 * (j + 1)) / columns];
      faces.push(quad([corner(u0, v0), corner(u0, v1), corner(u1, v1), corner(u1, v0)], colour));
    }
  }
  const sheet = merged(faces);
  smoothNormals(sheet, (x, y) => {
    const [u, v] = [(x - 1.35) / 1.0, (y - inner * EYE_OFFSET) / 0.78];
    return [0.242 * Math.max(0, u) ** 1.2, 0.09 * v, 1];
  });
  return sheet;
}

/** Replace the normals by those of the surface that the faces stand for. */
function smoothNormals(geometry, normalAt) {
  const { position, normal } = geometry.attributes;
  for (let n = 0; n < position.count; n++) {
    const [x, y, z] = normalAt(position.getX(n), position.getY(n));
    const length = Math.hypot(x, y, z);
    normal.setXYZ(n, x / length, y / length, z / length);
  }
}

/** A beam with a square section between two points. */
function beam([x0, y0, z0], [x1, y1, z1], wide, colour) {
  const length = Math.hypot(x1 - x0, y1 - y0, z1 - z0);
  const turn = new Matrix4().lookAt({ x: x1, y: y1, z: z1 }, { x: x0, y: y0, z: z0 }, { x: 0, y: 1, z: 0 });
  return box([wide, wide, length], [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2], colour, turn);
}

/** Pillars, roof edge and doors: what frames the view to the sides. */
function frameParts(inner) {
  const middle = inner * EYE_OFFSET;
  const parts = [];
  for (const side of [1, -1]) {
    const foot = [1.5, middle + side * 0.915, -0.63];
    const head = [0.32, middle + side * 0.64, 0.36];
    parts.push(beam(foot, head, 0.045, DARK));
    parts.push(box([1.5, 0.06, 0.5], [0.3, middle + side * 0.84, -0.53], PLASTIC));
  }
  parts.push(box([0.3, 1.3, 0.05], [0.1, middle, 0.33], DARK));
  return parts;
}

/** Vents and the middle console: quiet detail on the board. */
function consoleParts(inner) {
  const y = inner * 0.37;
  return [
    box([0.02, 0.26, 0.13], [0.655, y, -0.43], DARK),
    box([0.02, 0.23, 0.1], [0.643, y, -0.43], "#0d1114"),
    box([0.03, 1.45, 0.012], [0.642, y, -0.345], TRIM),
  ];
}

/** The wheel in its own plane: x to the driver's right, y up, z to the driver. */
function wheelParts() {
  const rim = coloured(new TorusGeometry(WHEEL.radius, 0.0155, 16, 72), "#202327");
  const mark = new TorusGeometry(WHEEL.radius, 0.0162, 16, 8, 0.16);
  mark.applyMatrix4(new Matrix4().makeRotationZ(Math.PI / 2 - 0.08));
  const hub = new CylinderGeometry(0.062, 0.072, 0.045, 40);
  hub.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2));
  const spoke = (angle, length) =>
    box([length, 0.03, 0.014], [0.055 + length / 2, 0, -0.008], "#3a3f44").applyMatrix4(
      new Matrix4().makeRotationZ(angle),
    );
  return [
    rim, coloured(mark, "#d8473a"), coloured(hub, "#24282c"),
    spoke(0.12, 0.125), spoke(Math.PI - 0.12, 0.125), spoke(-Math.PI / 2, 0.125),
  ];
}

/** The wheel: `turn` its inner group by the steering-wheel angle. */
function buildWheel(workshop) {
  const wheel = workshop.mesh(merged(wheelParts()), { side: DoubleSide });
  const plane = new Group();
  plane.add(wheel);
  // Columns: the driver's right, up along the leaning plane, back to the driver.
  const [s, c] = [Math.sin(WHEEL.lean), Math.cos(WHEEL.lean)];
  const basis = new Matrix4().set(0, s, -c, 0, -1, 0, 0, 0, 0, c, s, 0, 0, 0, 0, 1);
  plane.quaternion.setFromRotationMatrix(basis);
  plane.position.set(WHEEL.x, 0, WHEEL.z);
  return { plane, wheel };
}

export class Cockpit {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {number} inner
   * @param {string} colour of the own car
   */
  constructor(workshop, inner, colour) {
    this.group = new Group();
    const fixed = [board(inner), binnacle(), ...frameParts(inner), ...consoleParts(inner)];
    this.group.add(workshop.mesh(merged(fixed)), workshop.glossy(bonnet(inner, colour)));
    this.dashboard = new Dashboard(workshop.low);
    const face = this.dashboard.mesh(workshop, 0.3);
    const lean = 0.32;
    const [s, c] = [Math.sin(lean), Math.cos(lean)];
    face.quaternion.setFromRotationMatrix(
      new Matrix4().set(0, s, -c, 0, -1, 0, 0, 0, 0, c, s, 0, 0, 0, 0, 1),
    );
    face.position.set(0.79, 0, -0.252);
    const { plane, wheel } = buildWheel(workshop);
    this.wheel = wheel;
    this.group.add(face, plane);
  }

  /**
   * @param {{angle: number, speed: number, distance: number, indicator: number, time: number}}
   *   state `angle` of the steering wheel, left positive [rad]
   */
  update(state) {
    this.wheel.rotation.z = state.angle;
    this.dashboard.update(state);
  }
}
