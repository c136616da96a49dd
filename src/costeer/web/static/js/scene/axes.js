/**
 * Axes: the one place where the road's axes meet three's.
 *
 * Everything in the scene is built in the axes of the data, ISO 8855: x forward, y left,
 * z up. Three draws with x right, y up and z towards the viewer. A group turns the one
 * into the other, and a camera inside it is turned back so that it looks along x.
 */

import { Group, Matrix4, Quaternion, Vector3 } from "../../vendor/three.module.js";

const BASIS = new Matrix4().set(0, -1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 0, 0, 1);
const TO_THREE = new Quaternion().setFromRotationMatrix(BASIS);
const TO_ROAD = TO_THREE.clone().invert();
const UP = new Vector3(0, 0, 1);
const LEFT = new Vector3(0, 1, 0);

/** A group whose children live in x forward, y left, z up. */
export function roadAxes() {
  const group = new Group();
  group.quaternion.copy(TO_THREE);
  return group;
}

/**
 * Let a camera, child of such axes, look along x turned by an angle to the left.
 * @param {import("../../vendor/three.module.js").Camera} camera
 * @param {number} yaw positive to the left [rad]
 * @param {number} pitch positive downwards [rad]
 */
export function aim(camera, yaw, pitch = 0) {
  camera.quaternion.setFromAxisAngle(UP, yaw);
  camera.quaternion.multiply(new Quaternion().setFromAxisAngle(LEFT, pitch));
  camera.quaternion.multiply(TO_ROAD);
}
