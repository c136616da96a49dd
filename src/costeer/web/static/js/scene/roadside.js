/**
 * Roadside: guard rails, reflector posts, hedges, and stretches of trees and sound walls.
 *
 * What stands where depends on the place along the road alone: every trial passes the
 * same scenery, and the eye gets an even optic flow at both sides.
 */

import {
  Color, CylinderGeometry, Group, InstancedMesh, Matrix4, MeshBasicMaterial, PlaneGeometry,
  Vector3,
} from "../../vendor/three.module.js";
import { isCalm } from "./dashboard.js";
import { box, coloured, merged } from "./geometry.js";
import { AHEAD, BARRIER_DEPTH, BEHIND, PERIOD } from "./layout.js";
import { hash, stream } from "./random.js";
import { hedgeTexture, plantTextures, wallTexture } from "./textures.js";

const STEEL = "#c9ced1";
const WHITE_REFLECTOR = "#f6f7f2";
const ORANGE_REFLECTOR = "#ff9d2e";

/** Side view of a rail: distance towards the traffic and height [m]. */
const RAIL = [[0, 0.46], [0.07, 0.5], [0.07, 0.56], [0.01, 0.61], [0.07, 0.66], [0.07, 0.72], [0, 0.76]];

/** A rail along the whole scenery; `side` points from it to the traffic, -1 or +1. */
function rail({ ribbon }, y, side) {
  const facets = [];
  for (let n = 1; n < RAIL.length; n++) {
    const [low, high] = [RAIL[n - 1], RAIL[n]].map(([depth, z]) => [y + side * depth, z]);
    facets.push(side > 0 ? ribbon(low, high, STEEL) : ribbon(high, low, STEEL));
  }
  return merged(facets);
}

/** A matrix that moves. */
function at(x, y, z) {
  return new Matrix4().makeTranslation(x, y, z);
}

/** Put copies of a mesh at every `step` metres along the scenery, `reach` metres ahead. */
function fill(many, step, y, reach = AHEAD) {
  const first = Math.ceil(-Math.min(BEHIND, reach) / step) * step;
  for (let x = first; x < reach && many.count < many.instanceMatrix.count; x += step) {
    many.setMatrixAt(many.count++, at(x, y, 0));
  }
  return many;
}

/** Guard rails with posts at both sides of the carriageway, and the far one's. */
function rails(workshop, layout) {
  const o = layout.outer;
  const { verge } = layout;
  const lines = [
    [layout.outerBarrier + o * BARRIER_DEPTH, -o],
    [layout.innerBarrier - o * BARRIER_DEPTH, o],
    [layout.opposite + o * (verge + BARRIER_DEPTH), -o],
    [layout.oppositeFar - o * (verge + BARRIER_DEPTH), o],
  ];
  const most = Math.ceil((AHEAD + BEHIND) / 4) * lines.length;
  const posts = workshop.copies(box([0.11, 0.11, 0.8], [0, 0, 0.36], "#aab0b3"), most);
  const [shown, reach] = workshop.low ? [lines.slice(0, 2), 300] : [lines, 700];
  for (const [y, side] of shown) fill(posts, 4, y - side * 0.07, reach);
  return [workshop.mesh(merged(lines.map(([y, side]) => rail(layout, y, side)))), posts];
}

/** Reflector posts every 50 m: white at the outer side, orange at the median. */
function reflectors(workshop, layout) {
  const disc = new CylinderGeometry(0.055, 0.055, 0.02, workshop.low ? 5 : 12).applyMatrix4(
    new Matrix4().makeRotationZ(Math.PI / 2),
  );
  const post = (colour) => {
    const lens = coloured(disc.clone().translate(-0.03, 0, 1.02), colour);
    return merged([box([0.05, 0.07, 1.1], [0, 0, 0.53], "#eef0ee"), lens]);
  };
  const o = layout.outer;
  const places = [
    [layout.outerBarrier + o * 0.3, WHITE_REFLECTOR],
    [layout.innerBarrier - o * 0.3, ORANGE_REFLECTOR],
  ];
  const most = (AHEAD + BEHIND) / 50;
  return places.map(([y, colour]) => fill(workshop.copies(post(colour), most), 50, y));
}

/** A clipped hedge along the median, against glare. */
function hedge(workshop, layout) {
  const { ribbon } = layout;
  const middle = (layout.innerPaved + layout.opposite) / 2;
  const [half, top, tile] = [0.42, 1.05, 1.6];
  const [left, right] = [1, -1].map((side) => [
    [middle + side * half, 0.1], [middle + side * (half - 0.08), top],
  ]);
  const faces = [
    ribbon(left[1], right[1], "#ffffff", [tile, tile]),
    ribbon(...left, "#d5d8d0", [tile, tile]),
    ribbon(right[1], right[0], "#d5d8d0", [tile, tile]),
  ];
  const map = hedgeTexture(workshop.sharpness);
  return faces.map((face) => workshop.mesh(face, { map }));
}

/** What stands beside the road in a stretch of 100 m: 0 open, 1 wood, 2 sound wall. */
function stretch(number) {
  const kind = hash(Math.floor(number / 4), 71);
  if (kind < 0.3) return 2;
  return kind < 0.7 ? 1 : 0;
}

/**
 * Let copies of an upright picture turn about their stem towards the eye, whichever eye
 * it is: that of the driver or of a mirror.
 */
const FACING = `
vec4 mvPosition = modelMatrix * instanceMatrix * vec4(0.0, 0.0, 0.0, 1.0);
mvPosition = viewMatrix * vec4(bent(mvPosition.xyz), 1.0);
vec3 stem = normalize((modelViewMatrix * vec4(0.0, 0.0, 1.0, 0.0)).xyz);
vec3 side = normalize(cross(stem, -mvPosition.xyz));
mvPosition.xyz += side * position.x * length(instanceMatrix[0].xyz);
mvPosition.xyz += stem * position.z * length(instanceMatrix[2].xyz);
gl_Position = projectionMatrix * mvPosition;
`;

/** An upright picture, one metre wide and high. */
function picture() {
  const upright = new PlaneGeometry(1, 1).translate(0, 0.5, 0);
  return coloured(upright.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2)), "#ffffff");
}

/** Plants and walls of the stretches around the car. */
class Stretches {
  constructor(workshop, layout) {
    this.layout = layout;
    this.group = new Group();
    const most = workshop.low ? 300 : 1400;
    this.plants = plantTextures().map((map) => {
      const many = new InstancedMesh(picture(), new MeshBasicMaterial({ map, alphaTest: 0.5 }), most);
      many.frustumCulled = false;
      workshop.course.bend(many.material, FACING);
      return many;
    });
    const wall = wallGeometry();
    this.walls = workshop.copies(wall, 40, { map: wallTexture(workshop.sharpness), side: 2 });
    this.group.add(...this.plants, this.walls);
    this.density = (workshop.low ? 0.4 : 1) * (isCalm ? 0.4 : 1);
    this.reach = workshop.low ? 800 : AHEAD;
    this.first = null;
  }

  /** Bring the stretches up to date with the car's place [m]. */
  update(position) {
    const first = Math.floor(position / PERIOD) - BEHIND / PERIOD;
    if (first === this.first) return;
    this.first = first;
    const all = [...this.plants, this.walls];
    for (const many of all) many.count = 0;
    for (let n = 0; n < (BEHIND + AHEAD) / PERIOD; n++) this.add(first + n, n * PERIOD - BEHIND);
    for (const many of all) {
      many.instanceMatrix.needsUpdate = true;
      if (many.instanceColor) many.instanceColor.needsUpdate = true;
    }
  }

  /** Add one stretch that begins at x. */
  add(number, x) {
    const { outer, outerBarrier, verge } = this.layout;
    const far = this.layout.oppositeFar - outer * verge;
    const kind = stretch(number);
    if (kind === 2) {
      this.walls.setMatrixAt(this.walls.count++, at(x, outerBarrier + outer * 1.25, 0));
    }
    if (x > this.reach) return;
    this.wood(number, x, outerBarrier + outer * (kind === 2 ? 6 : 5), outer, kind);
    this.wood(number + 7919, x, far - outer * 5, -outer, stretch(number + 40) === 0 ? 0 : 1);
  }

  wood(seed, x, y, side, kind) {
    const next = stream(seed);
    const count = Math.round((kind === 0 ? 6 : 24) * this.density);
    for (let n = 0; n < count; n++) {
      const depth = (kind === 0 ? 60 : 26) * next() ** 1.6;
      const sort = depth < 2.5 ? 2 : next() < 0.55 ? 0 : 1;
      const tall = [7, 11, 1.7][sort] * (0.75 + 0.6 * next());
      const wide = tall * [0.95, 0.55, 1.5][sort];
      this.plant(sort, [x + PERIOD * next(), y + side * (depth + wide * 0.3), -1.35], wide, tall, next());
    }
  }

  plant(sort, place, wide, tall, shade) {
    const many = this.plants[sort];
    if (many.count >= many.instanceMatrix.count) return;
    const matrix = at(...place).scale(new Vector3(wide, wide, tall));
    many.setColorAt(many.count, new Color().setScalar(0.82 + 0.3 * shade));
    many.setMatrixAt(many.count++, matrix);
  }
}

/** A sound wall of one stretch, 3 m high, with panels of 4 m. */
function wallGeometry() {
  const geometry = new PlaneGeometry(PERIOD, 3.1, PERIOD / 5, 1);
  const { uv } = geometry.attributes;
  for (let n = 0; n < uv.count; n++) uv.setX(n, (uv.getX(n) * PERIOD) / 4);
  geometry.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2));
  return coloured(geometry.translate(PERIOD / 2, 0, 1.35), "#ffffff");
}

/**
 * Everything beside the road.
 * @returns {{fixed: Group, update: (position: number) => void}} `fixed` repeats every 100 m
 */
export function buildRoadside(workshop, layout) {
  const fixed = new Group();
  fixed.add(...rails(workshop, layout), ...reflectors(workshop, layout));
  fixed.add(...hedge(workshop, layout));
  const stretches = new Stretches(workshop, layout);
  fixed.add(stretches.group);
  return { fixed, update: (position) => stretches.update(position) };
}
