/**
 * Eye: where the driver's eye is, and what each screen shows of the world.
 */

import { PerspectiveCamera } from "../../vendor/three.module.js";
import { aim } from "./axes.js";

/** Of the eye above the road and from the car's middle, to the driver's side [m]. */
export const EYE_HEIGHT = 1.2;
export const EYE_OFFSET = 0.37;

/** Of the eye along the car, from its centre of gravity [m]. */
export const EYE_FORWARD = -0.1;

/**
 * Part of a screen's height that lies above the horizon [-]. Below it there is more to
 * see: road, wheel and instruments. The picture is shifted, not tilted.
 */
const ABOVE_HORIZON = 0.33;

const RADIAN = Math.PI / 180;

/**
 * Screens as planes around the eye, from left to right.
 * @param {number} count 1 to 3
 * @param {number} fov horizontal, of the whole set [deg]
 * @param {number|null} angle between neighbouring planes [deg]; null: each screen faces the eye
 * @returns {{yaw: number, left: number, right: number, unit: number}[]} `left` and `right` are
 *   edges at distance 1 in front of each plane; `unit` is the screens' common width there.
 */
export function screenPlanes(count, fov, angle) {
  const each = (fov / count) * RADIAN;
  const half = Math.tan(each / 2);
  const facing = (n) => {
    const yaw = ((count - 1) / 2 - n) * each;
    return { yaw, left: -half, right: half, unit: 2 * half };
  };
  if (count !== 3 || angle === null) return Array.from({ length: count }, (_, n) => facing(n));
  return sidePlanes(half, angle * RADIAN, facing(1));
}

/** Three equal screens whose side planes are turned by any angle about the middle's edges. */
function sidePlanes(half, angle, middle) {
  const distance = Math.cos(angle) + half * Math.sin(angle);
  const inner = (half * Math.cos(angle) - Math.sin(angle)) / distance;
  const unit = (2 * half) / distance;
  const left = { yaw: angle, left: -(inner + unit), right: -inner, unit };
  const right = { yaw: -angle, left: inner, right: inner + unit, unit };
  return [left, { ...middle, yaw: 0 }, right];
}

/** A plane that is wider by a factor, the same distance away. */
export function widened({ yaw, left, right, unit }, factor) {
  return { yaw, left: left * factor, right: right * factor, unit: unit * factor };
}

/**
 * Tangents of the upper and lower edge of a screen.
 * @param {number} unit width of a screen at distance 1
 * @param {number} aspect width over height of a screen
 */
export function verticalEdges(unit, aspect) {
  const height = unit / aspect;
  return { top: ABOVE_HORIZON * height, bottom: -(1 - ABOVE_HORIZON) * height };
}

/** A camera for one screen; `frame` sets it. */
export function screenCamera(near, far) {
  const camera = new PerspectiveCamera(60, 1, near, far);
  camera.matrixAutoUpdate = true;
  return camera;
}

/** Give a camera the view through a screen, from an eye in the axes of its parent. */
export function frame(camera, plane, aspect) {
  const { top, bottom } = verticalEdges(plane.unit, aspect);
  const n = camera.near;
  camera.projectionMatrix.makePerspective(
    plane.left * n, plane.right * n, top * n, bottom * n, n, camera.far,
    camera.coordinateSystem,
  );
  camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  aim(camera, plane.yaw);
}
