/**
 * Truck and lost load: what else is on the road.
 */

import { CanvasTexture, CylinderGeometry, PlaneGeometry, SRGBColorSpace } from "../../vendor/three.module.js";
import { box, coloured, merged } from "./geometry.js";
import { canvas } from "./textures.js";

const LENGTH = 12;
const WIDTH = 2.5;
const BLACK = "#17191b";
const AXLES = [4.4, -2.6, -3.9];

function wheels() {
  return AXLES.flatMap((x) => [1, -1].flatMap((side) => {
    const turn = (radius, width, y, colour) => coloured(
      new CylinderGeometry(radius, radius, width, 14).translate(x, side * y, 0.5), colour,
    );
    return [turn(0.5, 0.36, 1.04, BLACK), turn(0.3, 0.02, 1.23, "#a7adb0")];
  }));
}

function cab(colour) {
  const glass = "#1d262c";
  return [
    box([2.1, 2.4, 2.0], [4.85, 0, 1.75], colour),
    box([1.7, 2.3, 0.5], [4.65, 0, 2.95], colour),
    box([0.04, 2.1, 0.85], [5.91, 0, 2.15], glass),
    box([0.9, 2.42, 0.7], [5.1, 0, 2.15], glass),
    box([0.16, 2.42, 0.5], [5.9, 0, 0.65], BLACK),
    box([0.1, 0.24, 0.7], [5.55, 1.36, 2.1], BLACK),
    box([0.1, 0.24, 0.7], [5.55, -1.36, 2.1], BLACK),
  ];
}

/** The box: doors with bars at the back, rails along its sides. */
function load(colour) {
  const bars = [-0.62, -0.3, 0.3, 0.62].map((y) => box([0.04, 0.04, 2.5], [-6.0, y, 2.2], "#8d9396"));
  return [
    box([9.5, WIDTH, 2.7], [-1.22, 0, 2.2], colour),
    box([0.03, 0.03, 2.66], [-5.98, 0, 2.2], "#5c6164"),
    ...bars,
    box([9.4, 2.52, 0.1], [-1.22, 0, 0.9], "#6f7578"),
    box([9.4, 2.1, 0.28], [-1.22, 0, 0.74], BLACK),
    box([5.6, 2.46, 0.4], [0.7, 0, 0.58], "#3b4043"),
    box([0.1, 2.4, 0.14], [-5.95, 0, 0.5], BLACK),
    box([0.03, 0.34, 0.2], [-5.97, 0.35, 0.74], "#f0efe4"),
    // Reflecting strips that mark a long vehicle.
    box([0.03, 0.9, 0.13], [-5.985, 0.72, 1.05], "#d7352b"),
    box([0.03, 0.9, 0.13], [-5.985, -0.72, 1.05], "#d7352b"),
  ];
}

/** The meshes of a truck, with its middle at the origin; see `carParts`. */
export function truckParts(workshop, colour) {
  const solid = merged([...cab(colour), ...load("#e4e5e1"), ...wheels()]);
  const lamps = (y, wide) => box([0.06, wide, 0.14], [-5.99, y, 0.72], "#ffffff");
  const side = (s) => merged([
    lamps(s * 1.14, 0.14), box([0.1, 0.14, 0.14], [5.95, s * 1.1, 0.85], "#ffffff"),
  ]);
  return {
    size: [LENGTH, WIDTH], near: [workshop.mesh(solid)],
    far: [workshop.mesh(merged([...cab(colour), ...load("#e4e5e1")]))],
    brakes: merged([lamps(0.9, 0.3), lamps(-0.9, 0.3)]), left: side(1), right: side(-1),
  };
}

/** Stripes that warn, on the side of a crate. */
function stripes() {
  const { element, pen } = canvas(256, 128);
  pen.fillStyle = "#a98352";
  pen.fillRect(0, 0, 256, 128);
  pen.strokeStyle = "rgba(70,48,24,0.55)";
  pen.lineWidth = 3;
  for (let y = 0; y <= 128; y += 32) pen.strokeRect(0, y, 256, 32);
  for (const x of [6, 126, 246]) pen.fillRect(x - 6, 0, 12, 128);
  pen.fillStyle = "rgba(60,40,20,0.5)";
  for (const x of [6, 126, 246]) pen.strokeRect(x - 6, 0, 12, 128);
  const texture = new CanvasTexture(element);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

/** A crate that has fallen off a truck, as long as wide as `size` of one metre each. */
export function obstacleParts(workshop) {
  const face = new PlaneGeometry(0.98, 0.86).rotateZ(Math.PI / 2).rotateY(-Math.PI / 2);
  const front = workshop.plain(face.translate(-0.505, 0, 0.47), { map: stripes() });
  const solid = merged([
    box([1, 1, 0.84], [0, 0, 0.48], "#9a7747"), box([1.06, 1.06, 0.06], [0, 0, 0.91], "#7d5f37"),
    box([1.06, 1.06, 0.06], [0, 0, 0.03], "#6f5330"), box([0.4, 0.5, 0.3], [0.1, -0.1, 1.08], "#3d6c9c"),
  ]);
  return { size: [1, 1], near: [workshop.mesh(solid), front], far: [workshop.mesh(solid.clone())] };
}
