/**
 * Sky: a dome that is brighter at the horizon, hills in the haze, clouds and the sun.
 */

import {
  BackSide, BufferAttribute, BufferGeometry, Color, DoubleSide, Group, Matrix4, Mesh,
  MeshBasicMaterial, PlaneGeometry, SphereGeometry, Vector3,
} from "../../vendor/three.module.js";
import { SUN } from "./geometry.js";
import { hash, stream } from "./random.js";
import { canvas, textureOf } from "./textures.js";

/** Colour of the air far away: the fog takes things into it. */
export const HAZE = "#cfdde6";

const RADIUS = 4000;
const ZENITH = new Color("#4a86c5");
const MIDDLE = new Color("#8fb9dd");

function dome(low) {
  const geometry = new SphereGeometry(RADIUS, low ? 12 : 32, low ? 40 : 64).applyMatrix4(
    new Matrix4().makeRotationX(Math.PI / 2),
  );
  const { position } = geometry.attributes;
  const values = new Float32Array(3 * position.count);
  const haze = new Color(HAZE);
  for (let n = 0; n < position.count; n++) {
    const height = Math.max(0, position.getZ(n) / RADIUS);
    const colour = haze.clone().lerp(MIDDLE, Math.min(1, height / 0.22) ** 0.8);
    colour.lerp(ZENITH, Math.max(0, height - 0.12) ** 0.8);
    values.set([colour.r, colour.g, colour.b], 3 * n);
  }
  geometry.setAttribute("color", new BufferAttribute(values, 3));
  return new Mesh(geometry, skyMaterial({ vertexColors: true, side: BackSide }));
}

function skyMaterial(look) {
  return new MeshBasicMaterial({ fog: false, depthWrite: false, ...look });
}

/** Height of a chain of hills at a bearing, as a tangent. */
function ridge(seed, degrees, height) {
  let sum = 0;
  for (const [octave, spacing] of [[0, 24], [1, 9], [2, 3.6], [3, 1.5]]) {
    const place = degrees / spacing;
    const cell = Math.floor(place);
    const steps = Math.round(360 / spacing);
    const [a, b] = [hash(seed + octave, cell % steps), hash(seed + octave, (cell + 1) % steps)];
    const t = place - cell;
    sum += (a + (b - a) * t * t * (3 - 2 * t)) / 2.1 ** octave;
  }
  return height * (0.35 + 0.65 * (sum / 1.8));
}

/** A chain of hills all around, a band from below the horizon up to its ridge. */
function hills(seed, radius, height, colour, step) {
  const points = [];
  const around = (degrees, z) => {
    const angle = (degrees * Math.PI) / 180;
    return [radius * Math.cos(angle), radius * Math.sin(angle), z];
  };
  for (let degree = 0; degree < 360; degree += step) {
    const [a, b] = [degree, degree + step];
    const low = -0.02 * radius;
    const [za, zb] = [a, b].map((at) => radius * ridge(seed, at % 360, height));
    points.push(around(a, low), around(b, low), around(b, zb));
    points.push(around(a, low), around(b, zb), around(a, za));
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.flat()), 3));
  return new Mesh(geometry, skyMaterial({ color: colour, side: DoubleSide }));
}

function cloudTexture(seed) {
  const { element, pen } = canvas(256, 128);
  const next = stream(seed);
  for (let n = 0; n < 70; n++) {
    const spread = next() + next() - 1;
    const x = 128 + 95 * spread;
    const y = 88 - 46 * next() * (1 - Math.abs(spread));
    const r = 8 + 24 * next() * (1 - Math.abs(spread));
    const fade = pen.createRadialGradient(x, y, 0, x, y, r);
    fade.addColorStop(0, "rgba(255,255,255,0.30)");
    fade.addColorStop(1, "rgba(255,255,255,0)");
    pen.fillStyle = fade;
    pen.fillRect(0, 0, 256, 128);
  }
  return textureOf(element);
}

/** A picture that hangs in the sky and faces the middle. */
function hung(texture, { bearing, elevation, width, height, opacity = 1 }) {
  const look = { map: texture, transparent: true, opacity };
  const mesh = new Mesh(new PlaneGeometry(width, height), skyMaterial(look));
  const flat = RADIUS * 0.9 * Math.cos(elevation);
  const place = new Vector3(flat * Math.cos(bearing), flat * Math.sin(bearing), 0);
  place.z = RADIUS * 0.9 * Math.sin(elevation);
  const inward = place.clone().negate().normalize();
  const side = new Vector3(0, 0, 1).cross(inward).normalize();
  const up = inward.clone().cross(side);
  mesh.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(side, up, inward));
  mesh.position.copy(place);
  return mesh;
}

function clouds(count) {
  const textures = [51, 52, 53].map(cloudTexture);
  const next = stream(54);
  return Array.from({ length: count }, (_, n) => {
    const width = 500 + 900 * next();
    return hung(textures[n % 3], {
      bearing: 2 * Math.PI * ((n + 0.7 * next()) / count),
      elevation: 0.09 + 0.36 * next() ** 1.4,
      width,
      height: width * (0.22 + 0.12 * next()),
      opacity: 0.55 + 0.35 * next(),
    });
  });
}

function sun() {
  const { element, pen } = canvas(256, 256);
  const fade = pen.createRadialGradient(128, 128, 0, 128, 128, 128);
  fade.addColorStop(0, "rgba(255,253,240,1)");
  fade.addColorStop(0.1, "rgba(255,250,228,1)");
  fade.addColorStop(0.16, "rgba(255,246,214,0.42)");
  fade.addColorStop(1, "rgba(255,244,210,0)");
  pen.fillStyle = fade;
  pen.fillRect(0, 0, 256, 256);
  const bearing = Math.atan2(SUN.y, SUN.x);
  return hung(textureOf(element), {
    bearing, elevation: Math.asin(SUN.z), width: 900, height: 900,
  });
}

/** The sky, around the origin; it moves with the car and does not turn. */
export function buildSky(low) {
  const sky = new Group();
  const step = low ? 1.5 : 0.5;
  const parts = [
    dome(low),
    hills(61, 3500, 0.075, "#b3c8d6", step),
    hills(62, 3300, 0.055, "#a0b9c6", step),
    hills(63, 3100, 0.034, "#8fabb0", step),
    sun(),
    ...clouds(low ? 12 : 26),
  ];
  // After all else: what is hidden by the world need not be drawn.
  parts.forEach((part, order) => {
    part.renderOrder = 100 + order;
    sky.add(part);
  });
  return sky;
}
