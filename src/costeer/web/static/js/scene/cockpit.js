/**
 * Cockpit: what the driver sees of the own car, in axes with the eye at the origin.
 *
 * `inner` is +1 where the car's middle lies to the left of the driver (right-hand drive),
 * -1 where it lies to the right.
 */

import {
  CylinderGeometry, DoubleSide, Group, Matrix4, TorusGeometry,
} from "../../vendor/three.module.js";
import { Dashboard } from "./dashboard.js";
import { EYE_OFFSET } from "./eye.js";
import { box, coloured, merged, quad } from "./geometry.js";
import { interiorParts } from "./interior.js";

/**
 * Steering wheel: middle, radius and lean of its plane [m, rad]. Far and small enough that
 * all of it is seen on one screen.
 */
const WHEEL = { x: 0.8, z: -0.236, radius: 0.16, lean: 0.4 };

/** The instruments above the wheel's hub: inside the view through each of three screens. */
const FACE = { x: 0.995, z: -0.186, width: 0.27, lean: 0.2 };

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

/** The wheel in its own plane: x to the driver's right, y up, z to the driver. */
function wheelParts(low) {
  const { radius } = WHEEL;
  const [tube, around] = low ? [9, 44] : [18, 80];
  const rim = coloured(new TorusGeometry(radius, 0.0145, tube, around), "#24282b");
  // Leather of another kind where the hands are.
  const grips = [0, Math.PI].map((angle) => {
    const grip = new TorusGeometry(radius, 0.0158, tube, 12, 1.0);
    return coloured(grip.applyMatrix4(new Matrix4().makeRotationZ(angle - 0.35)), "#2f3438");
  });
  const mark = new TorusGeometry(radius, 0.0168, tube, 4, 0.12);
  mark.applyMatrix4(new Matrix4().makeRotationZ(Math.PI / 2 - 0.06));
  const hub = new CylinderGeometry(0.043, 0.052, 0.04, 40);
  hub.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2));
  const emblem = new CylinderGeometry(0.014, 0.014, 0.006, 28);
  emblem.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2)).translate(0, 0, 0.022);
  const spoke = (angle, wide) =>
    box([0.118, wide, 0.012], [0.099, 0, -0.006], "#33383c").applyMatrix4(
      new Matrix4().makeRotationZ(angle),
    );
  const bright = (angle) =>
    box([0.05, 0.022, 0.004], [0.078, 0, 0.003], "#596067").applyMatrix4(new Matrix4().makeRotationZ(angle));
  return [
    rim, ...grips, coloured(mark, "#c9453a"), coloured(hub, "#2a2e32"), coloured(emblem, "#b9c0c5"),
    spoke(0.1, 0.034), spoke(Math.PI - 0.1, 0.034), spoke(-Math.PI / 2, 0.04),
    bright(0.1), bright(Math.PI - 0.1),
  ];
}

/** Turn a plane to the driver: its x to the driver's right, its top leaning away. */
function facing(group, lean) {
  const [s, c] = [Math.sin(lean), Math.cos(lean)];
  const basis = new Matrix4().set(0, s, -c, 0, -1, 0, 0, 0, 0, c, s, 0, 0, 0, 0, 1);
  group.quaternion.setFromRotationMatrix(basis);
  return group;
}

export class Cockpit {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {number} inner
   * @param {string} colour of the own car
   */
  constructor(workshop, inner, colour) {
    this.group = new Group();
    const fixed = interiorParts(inner * EYE_OFFSET, inner);
    this.group.add(workshop.mesh(fixed), workshop.glossy(bonnet(inner, colour)));
    this.dashboard = new Dashboard(workshop.low);
    const face = facing(this.dashboard.mesh(workshop, FACE.width), FACE.lean);
    face.position.set(FACE.x, 0, FACE.z);
    this.wheel = workshop.mesh(merged(wheelParts(workshop.low)), { side: DoubleSide });
    const plane = facing(new Group(), WHEEL.lean);
    plane.position.set(WHEEL.x, 0, WHEEL.z);
    plane.add(this.wheel);
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
