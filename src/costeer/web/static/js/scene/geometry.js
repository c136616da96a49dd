/**
 * Geometry: coloured parts that are joined into one mesh, one call to draw.
 */

import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, ExtrudeGeometry, Matrix4, Shape, Vector3,
} from "../../vendor/three.module.js";

/** Direction to the sun: behind on the left, so that it lights the backs of cars ahead. */
export const SUN = new Vector3(-0.45, 0.55, 0.7).normalize();

/** Share of the light that comes from all sides [-]. */
const AMBIENT = 0.62;

/** Give every vertex one colour. */
export function coloured(geometry, colour) {
  const plain = geometry.index ? geometry.toNonIndexed() : geometry;
  const { r, g, b } = new Color(colour);
  const count = plain.attributes.position.count;
  const values = new Float32Array(3 * count);
  for (let n = 0; n < count; n++) values.set([r, g, b], 3 * n);
  plain.setAttribute("color", new BufferAttribute(values, 3));
  return plain;
}

/** A coloured box by its size and middle. */
export function box(size, middle, colour, turn = null) {
  const geometry = new BoxGeometry(...size);
  if (turn) geometry.applyMatrix4(turn);
  geometry.translate(...middle);
  return coloured(geometry, colour);
}

/** A shape from points. */
export function outline(points) {
  const shape = new Shape();
  points.forEach(([a, b], n) => (n === 0 ? shape.moveTo(a, b) : shape.lineTo(a, b)));
  shape.closePath();
  return shape;
}

/**
 * A body whose side view is a shape of (x, z), drawn out along y around `y = 0`.
 * @param {Shape} shape
 * @param {number} width along y, bevel included [m]
 * @param {number} bevel radius of its rounded edges [m]
 * @param {boolean} coarse with few faces, for machines that draw slowly
 */
export function drawnOut(shape, width, bevel = 0, coarse = false) {
  const geometry = new ExtrudeGeometry(shape, {
    depth: width - 2 * bevel,
    bevelEnabled: bevel > 0,
    bevelSize: bevel,
    bevelOffset: -bevel,
    bevelThickness: bevel,
    bevelSegments: coarse ? 1 : 3,
    curveSegments: coarse ? 5 : 20,
  });
  geometry.translate(0, 0, -(width - 2 * bevel) / 2);
  return geometry.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2));
}

/** A flat piece with four corners, counter-clockwise as seen from its front. */
export function quad(corners, colour, withTexture = false) {
  const order = [0, 1, 2, 0, 2, 3];
  const geometry = new BufferGeometry();
  const points = new Float32Array(order.flatMap((n) => corners[n]));
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const corner = [[0, 0], [1, 0], [1, 1], [0, 1]];
  const places = new Float32Array(order.flatMap((n) => corner[n]));
  if (withTexture) geometry.setAttribute("uv", new BufferAttribute(places, 2));
  geometry.computeVertexNormals();
  return coloured(geometry, colour);
}

/** One geometry of many; of the attributes positions, normals and colours are kept. */
export function merged(parts) {
  const joined = new BufferGeometry();
  for (const name of ["position", "normal", "color"]) {
    const arrays = parts.map((part) => part.attributes[name].array);
    const values = new Float32Array(arrays.reduce((sum, array) => sum + array.length, 0));
    let place = 0;
    for (const array of arrays) {
      values.set(array, place);
      place += array.length;
    }
    joined.setAttribute(name, new BufferAttribute(values, 3));
  }
  return joined;
}

/** Multiply the colours by the light that falls on each vertex: for unlit materials. */
export function shaded(geometry) {
  const { normal, color } = geometry.attributes;
  const direction = new Vector3();
  for (let n = 0; n < color.count; n++) {
    direction.fromBufferAttribute(normal, n);
    const sky = 0.85 + 0.15 * direction.z;
    const light = AMBIENT * sky + (1 - AMBIENT) * 1.25 * Math.max(0, direction.dot(SUN));
    color.setXYZ(n, color.getX(n) * light, color.getY(n) * light, color.getZ(n) * light);
  }
  return geometry;
}
