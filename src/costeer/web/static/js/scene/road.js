/**
 * Road: asphalt with its markings, as one texture that repeats every 20 m.
 *
 * Markings are part of the texture and not bodies on the road: so they cannot flicker
 * with it, and far away they are blurred evenly instead of breaking into steps.
 */

import { Group } from "../../vendor/three.module.js";
import { merged, quad } from "./geometry.js";
import { stream } from "./random.js";
import { blobs, canvas, grain, textureOf } from "./textures.js";

/** Japanese expressway: dashes of 8 m, gaps of 12 m. */
const PATTERN = 20;
const DASH = 8;
const DASH_WIDTH = 0.15;
const EDGE_WIDTH = 0.2;
const PAINT = "#e9e9e2";

/** Rumble strip: beyond the outer lines, grooves across the road (plant/place.py) [m]. */
const STRIP = { begins: 0.1, width: 0.4, grooves: 33 };

/** Places on the texture: across in metres from the carriageway's left edge. */
function plan(layout, low) {
  // Seen along the road a texture is squeezed. Where little is done against it while
  // drawing, few points along the road keep the lines sharp across it.
  const [width, height] = low ? [1024, 224] : [2048, 2048];
  const left = Math.max(layout.outerPaved, layout.innerPaved);
  return { width, height, across: (y) => ((left - y) / layout.width) * width, left };
}

function line(pen, map, y, width, from, to) {
  const [x0, x1] = [map.across(y + width / 2), map.across(y - width / 2)];
  const [y0, y1] = [(from / PATTERN) * map.height, (to / PATTERN) * map.height];
  pen.fillStyle = PAINT;
  pen.fillRect(x0, y0, x1 - x0, y1 - y0);
  // Worn paint: the asphalt shows through in places.
  const next = stream(Math.round(1000 * (y + 50)));
  pen.fillStyle = "rgba(84,86,88,0.5)";
  for (let n = 0; n < 26 * (to - from); n++) {
    pen.fillRect(x0 + next() * (x1 - x0), y0 + next() * (y1 - y0), 1 + 2 * next(), 1 + 2 * next());
  }
}

/** Slightly darker where wheels run, and a trace of oil between them. */
function tracks(pen, map, layout) {
  for (let lane = 0; lane < layout.numLanes; lane++) {
    const middle = layout.centre(lane);
    for (const [offset, half, depth] of [[0.78, 0.42, 0.13], [-0.78, 0.42, 0.13], [0, 0.3, 0.06]]) {
      const [x0, x1] = [map.across(middle + offset + half), map.across(middle + offset - half)];
      const fade = pen.createLinearGradient(x0, 0, x1, 0);
      fade.addColorStop(0, "rgba(20,20,22,0)");
      fade.addColorStop(0.5, `rgba(20,20,22,${depth})`);
      fade.addColorStop(1, "rgba(20,20,22,0)");
      pen.fillStyle = fade;
      pen.fillRect(x0, 0, x1 - x0, map.height);
    }
  }
}

/** Milled grooves: a dark and a bright edge each. */
function strip(pen, map, y, side) {
  const edges = [STRIP.begins, STRIP.begins + STRIP.width].map((out) => map.across(y + side * out));
  const [x0, x1] = edges.sort((a, b) => a - b);
  const pitch = map.height / STRIP.grooves;
  for (let n = 0; n < STRIP.grooves; n++) {
    pen.fillStyle = "rgba(28,29,31,0.55)";
    pen.fillRect(x0, n * pitch, x1 - x0, pitch * 0.42);
    pen.fillStyle = "rgba(160,162,160,0.35)";
    pen.fillRect(x0, (n + 0.42) * pitch, x1 - x0, pitch * 0.14);
  }
}

function asphalt(layout, low, sharpness) {
  const map = plan(layout, low);
  const { element, pen } = canvas(map.width, map.height);
  pen.fillStyle = "#66696b";
  pen.fillRect(0, 0, map.width, map.height);
  blobs(pen, element, 26, "rgba(40,42,46,0.10)", 21, map.width / 6);
  blobs(pen, element, 26, "rgba(150,150,145,0.07)", 22, map.width / 6);
  const tones = ["#5b5e60", "#727577", "#7d8081", "#525557", "#6b6e70"];
  grain(pen, element, (map.width * map.height) / 22, tones, 23, map.width / 700);
  tracks(pen, map, layout);
  if (layout.hasStrip) {
    strip(pen, map, layout.outerEdge, layout.outer);
    strip(pen, map, layout.innerEdge, -layout.outer);
  }
  const inset = layout.outer * 0.02;
  line(pen, map, layout.outerEdge - inset, EDGE_WIDTH, 0, PATTERN);
  line(pen, map, layout.innerEdge + inset, EDGE_WIDTH, 0, PATTERN);
  for (let lane = 1; lane < layout.numLanes; lane++) {
    line(pen, map, layout.centre(lane) - layout.lane / 2, DASH_WIDTH, 0, DASH);
  }
  return textureOf(element, { repeat: true, sharpness });
}

/** Ground beside the road: verges, banks and median. */
function ground(workshop, layout, map) {
  const { outer: o, innerPaved, opposite, ribbon } = layout;
  const far = layout.oppositeFar - o * layout.verge;
  const pieces = [
    ...bank(layout.outerPaved, layout.outerBarrier, o),
    [[innerPaved, 0], [opposite, 0]],
    ...bank(layout.oppositeFar, far, -o),
  ];
  const fromLeft = pieces.map((piece) => piece.sort(([a], [b]) => b - a));
  const tones = ["#c9c4b0", "#ffffff", "#ffffff", "#e8e6d4", "#c9c4b0", "#ffffff", "#ffffff"];
  return fromLeft.map((piece, n) => workshop.mesh(ribbon(...piece, tones[n], [10, 10]), { map }));
}

/** From the pavement's edge past the barrier down to the fields. */
function bank(paved, barrier, side) {
  const [brink, foot, end] = [1.2, 9, 42].map((out) => barrier + side * out);
  return [
    [[paved, 0], [brink, -0.12]],
    [[brink, -0.12], [foot, -1.3]],
    [[foot, -1.3], [end, -1.3]],
  ];
}

/** Side of the fields [m], and size of a piece of their texture. */
const FIELDS = 5200;
const TILE = 10;

/**
 * The fields beyond, one flat piece: it does not bend with the road but stands still while
 * the road turns over it.
 */
export function buildFields(workshop, map) {
  const half = FIELDS / 2;
  const corners = [[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]];
  const geometry = quad(corners, "#ffffff", true);
  const { uv } = geometry.attributes;
  for (let n = 0; n < uv.count; n++) uv.setXY(n, (uv.getX(n) * FIELDS) / TILE, (uv.getY(n) * FIELDS) / TILE);
  const mesh = workshop.mesh(geometry, { map });
  const update = ({ x, y, heading }) => {
    const [dx, dy] = [x, y].map((place) => Math.round(place / TILE) * TILE - place);
    const [c, s] = [Math.cos(heading), Math.sin(heading)];
    mesh.position.set(c * dx + s * dy, c * dy - s * dx, -1.5);
    mesh.rotation.z = -heading;
  };
  return { mesh, update };
}

/** Low kerbs at both sides of the median. */
function kerbs(layout) {
  const { outer: o, ribbon } = layout;
  const faces = [];
  const far = layout.opposite + o * layout.verge;
  for (const [y, side] of [[layout.innerBarrier - o * 0.2, o], [far + o * 0.2, -o]]) {
    const [foot, edge, back] = [[y, 0], [y, 0.14], [y - side * 0.16, 0.14]];
    faces.push(side > 0 ? ribbon(foot, edge, "#b5b6b2") : ribbon(edge, foot, "#b5b6b2"));
    faces.push(side > 0 ? ribbon(edge, back, "#c3c4bf") : ribbon(back, edge, "#c3c4bf"));
  }
  return merged(faces);
}

/**
 * The road and the ground, around the car; it repeats every 20 m along x.
 * @param {import("./workshop.js").Workshop} workshop
 */
export function buildRoad(workshop, layout, grass) {
  const { ribbon } = layout;
  const road = new Group();
  const map = asphalt(layout, workshop.low, workshop.roadSharpness);
  const tile = [layout.width, PATTERN];
  const left = Math.max(layout.outerPaved, layout.innerPaved);
  road.add(workshop.mesh(ribbon([left, 0], [left - layout.width, 0], "#ffffff", tile), { map }));
  road.add(workshop.mesh(oppositeStrip(layout, tile), { map }));
  road.add(...ground(workshop, layout, grass), workshop.mesh(kerbs(layout)));
  return road;
}

/** The other carriageway: the same, turned around, so that its shoulders fit. */
function oppositeStrip(layout, tile) {
  const [a, b] = [layout.opposite, layout.oppositeFar];
  const geometry = layout.ribbon([Math.max(a, b), 0], [Math.min(a, b), 0], "#f4f4f4", tile);
  const { uv } = geometry.attributes;
  for (let n = 0; n < uv.count; n++) uv.setXY(n, 1 - uv.getX(n), -uv.getY(n));
  return geometry;
}
