/**
 * Ribbons: long faces along the road.
 *
 * They are cut into short pieces. A face that reaches from far behind the eye to the
 * horizon is clipped so unevenly that its depth is wrong by metres, and things behind it
 * shine through; and a piece is what a curve is made of.
 */

import { coloured, quad } from "./geometry.js";
import { AHEAD, BEHIND } from "./layout.js";
import { BufferAttribute, BufferGeometry } from "../../vendor/three.module.js";

/** Length of a piece from a place on: short where the eye is, longer far away [m]. */
const STRAIGHT = [[-BEHIND, 50], [-50, 10], [100, 50], [400, 100]];
const CURVED = [[-BEHIND, 20], [-80, 5], [150, 10], [400, 25], [900, 50]];

function cuts(steps) {
  const found = [];
  steps.forEach(([from, step], n) => {
    const end = steps[n + 1]?.[0] ?? AHEAD;
    for (let x = from; x < end; x += step) found.push(x);
  });
  return [...found, AHEAD];
}

/** Copy the attributes of many pieces into one geometry. */
function joined(pieces) {
  const geometry = new BufferGeometry();
  for (const [name, { itemSize }] of Object.entries(pieces[0].attributes)) {
    const values = pieces.flatMap((piece) => [...piece.attributes[name].array]);
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), itemSize));
  }
  return geometry;
}

/**
 * What makes faces along the whole scenery between two lines, for a straight or a curved road:
 * of `[y, z]` of the line on its left, as seen from its front along the road, that of the other
 * line [m], a colour, and the size of its texture across and along [m], if it has one.
 */
export function ribbons(isStraight) {
  const places = cuts(isStraight ? STRAIGHT : CURVED);
  return ([y0, z0], [y1, z1], colour, tile = null) => {
    const pieces = places.slice(1).map((front, n) => {
      const back = places[n];
      return quad([[back, y0, z0], [back, y1, z1], [front, y1, z1], [front, y0, z0]], colour);
    });
    const geometry = coloured(joined(pieces), colour);
    if (tile) addTexturePlaces(geometry, [y0, z0], tile);
    return geometry;
  };
}

function addTexturePlaces(geometry, [y0, z0], [across, along]) {
  const { position } = geometry.attributes;
  const uv = new Float32Array(2 * position.count);
  for (let n = 0; n < position.count; n++) {
    const [y, z] = [position.getY(n), position.getZ(n)];
    uv.set([Math.hypot(y - y0, z - z0) / across, position.getX(n) / along], 2 * n);
  }
  geometry.setAttribute("uv", new BufferAttribute(uv, 2));
}
