/**
 * Car: a saloon of usual size, built of a few drawn-out side views.
 */

import { CylinderGeometry, Matrix4, PlaneGeometry, Shape } from "../../vendor/three.module.js";
import { box, coloured, drawnOut, merged, outline, quad } from "./geometry.js";
import { canvas, textureOf } from "./textures.js";

/** Over all [m]. */
const LENGTH = 4.55;
const WIDTH = 1.78;
const GLASS = "#1d262c";
const BLACK = "#16181a";
const WHEEL_PLACES = [1.38, -1.32];
const WHEEL_RADIUS = 0.32;

/** Side view of the body below the windows: x forward, z up. */
function bodyShape() {
  const shape = new Shape();
  shape.moveTo(-2.18, 0.28);
  shape.quadraticCurveTo(-2.28, 0.55, -2.2, 0.86);
  shape.quadraticCurveTo(-2.16, 0.97, -2.0, 0.985);
  shape.lineTo(0.95, 0.95);
  shape.quadraticCurveTo(1.95, 0.86, 2.12, 0.68);
  shape.quadraticCurveTo(2.26, 0.5, 2.2, 0.28);
  for (const x of WHEEL_PLACES) {
    shape.lineTo(x + 0.37, 0.24);
    shape.absarc(x, 0.3, 0.37, -0.16, Math.PI + 0.16, false);
  }
  shape.lineTo(-2.18, 0.28);
  return shape;
}

/** Half the width of the cabin at a height: it leans in towards the roof. */
function halfCabin(z) {
  return 0.815 - 0.36 * Math.max(0, z - 0.94);
}

const CABIN = [[-1.92, 0.94], [-1.12, 1.39], [-0.85, 1.445], [0.1, 1.455], [0.4, 1.41], [1.22, 0.93]];

/** The cabin, leaning in. */
function cabin(colour, coarse) {
  const geometry = drawnOut(outline(CABIN), 1.63, 0.05, coarse);
  const { position } = geometry.attributes;
  for (let n = 0; n < position.count; n++) {
    position.setY(n, (position.getY(n) * halfCabin(position.getZ(n))) / halfCabin(0.94));
  }
  geometry.computeVertexNormals();
  return coloured(geometry, colour);
}

/** A window across the car between two heights on a slope, a little in front of it. */
function crossWindow([x0, z0], [x1, z1], out) {
  const [low, high] = [halfCabin(z0) - 0.09, halfCabin(z1) - 0.09];
  const corners = [[x0 + out, low, z0 + 0.02], [x0 + out, -low, z0 + 0.02], [x1 + out, -high, z1 + 0.02], [x1 + out, high, z1 + 0.02]];
  return quad(out < 0 ? corners : corners.reverse(), GLASS);
}

/** Windows of one side. */
function sideWindows(side) {
  const at = (x, z) => [x, side * (halfCabin(z) + 0.012), z];
  const panes = [
    [[-1.5, 0.99], [-0.52, 0.99], [-0.52, 1.36], [-1.0, 1.34]],
    [[-0.42, 0.99], [0.98, 0.99], [0.36, 1.34], [-0.42, 1.36]],
  ];
  return panes.map((pane) => {
    const corners = pane.map(([x, z]) => at(x, z));
    return quad(side > 0 ? corners.reverse() : corners, GLASS);
  });
}

function wheel(x, side, coarse) {
  const turn = (radius, width, y, colour) =>
    coloured(new CylinderGeometry(radius, radius, width, coarse ? 12 : 24).translate(x, side * y, WHEEL_RADIUS), colour);
  return [turn(WHEEL_RADIUS, 0.2, 0.775, BLACK), turn(0.21, 0.02, 0.87, "#aeb4b8")];
}

/** Brake lamps. */
function brakeLamps() {
  return merged([
    box([0.06, 0.36, 0.13], [-2.215, 0.66, 0.78], "#ffffff"),
    box([0.06, 0.36, 0.13], [-2.215, -0.66, 0.78], "#ffffff"),
    box([0.04, 0.34, 0.03], [-1.12, 0, 1.405], "#ffffff"),
  ]);
}

/** Indicators of one side: rear, front, and in the mirror. */
function indicators(side) {
  return merged([
    box([0.065, 0.12, 0.12], [-2.215, side * 0.79, 0.66], "#ffffff"),
    box([0.1, 0.12, 0.1], [2.08, side * 0.8, 0.68], "#ffffff"),
    box([0.03, 0.05, 0.05], [0.9, side * 0.99, 1.0], "#ffffff"),
  ]);
}

function numberPlate() {
  const { element, pen } = canvas(256, 128);
  pen.fillStyle = "#f3f4ef";
  pen.fillRect(0, 0, 256, 128);
  pen.strokeStyle = pen.fillStyle = "#1f5a3c";
  pen.lineWidth = 6;
  pen.strokeRect(6, 6, 244, 116);
  pen.font = "600 66px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.fillText("20-46", 128, 104);
  pen.font = "600 26px system-ui, sans-serif";
  pen.fillText("500", 128, 38);
  return textureOf(element, { sharpness: 4 });
}

/** Parts that hang on the outside: bumpers, lamps in front, mirrors. */
function details(colour) {
  return [
    box([0.1, 1.5, 0.16], [-2.18, 0, 0.36], BLACK),
    box([0.1, 1.2, 0.16], [2.17, 0, 0.4], BLACK),
    box([0.12, 0.36, 0.1], [2.1, 0.62, 0.68], "#e8eef2"),
    box([0.12, 0.36, 0.1], [2.1, -0.62, 0.68], "#e8eef2"),
    box([0.14, 0.2, 0.13], [0.82, 0.93, 1.0], colour),
    box([0.14, 0.2, 0.13], [0.82, -0.93, 1.0], colour),
    box([0.02, 1.3, 0.012], [-2.225, 0, 0.64], "#2a2d30"),
  ];
}

/** A saloon far away: its body and cabin without wheels' rounds and details. */
function distant(colour) {
  const side = [[-2.2, 0.28], [-2.2, 0.95], [0.95, 0.95], [2.1, 0.66], [2.2, 0.28]];
  return merged([
    coloured(drawnOut(outline(side), WIDTH), colour), cabin(colour, true),
    box([4.0, 1.6, 0.3], [0, 0, 0.2], BLACK),
  ]);
}

/** Glass all around. */
function windows() {
  return merged([
    crossWindow([-1.86, 0.975], [-1.19, 1.355], -0.03),
    crossWindow([1.13, 0.985], [0.46, 1.365], 0.03),
    ...sideWindows(1), ...sideWindows(-1),
  ]);
}

function plate(workshop) {
  const mesh = workshop.plain(new PlaneGeometry(0.33, 0.165), { map: numberPlate() });
  mesh.geometry.applyMatrix4(new Matrix4().set(0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1));
  mesh.geometry.translate(-2.285, 0, 0.56);
  return mesh;
}

/**
 * The meshes of a car of one colour, with its middle at the origin, wheels on z = 0.
 * @param {import("./workshop.js").Workshop} workshop
 */
export function carParts(workshop, colour) {
  const { low } = workshop;
  const body = coloured(drawnOut(bodyShape(), WIDTH, 0.09, low), colour);
  const paint = merged([body, cabin(colour, low), ...details(colour)]);
  const wheels = merged(WHEEL_PLACES.flatMap((x) => [...wheel(x, 1, low), ...wheel(x, -1, low)]));
  // What is lit alike is drawn at once.
  const near = low
    ? [workshop.mesh(merged([paint, windows(), wheels])), plate(workshop)]
    : [
      workshop.glossy(paint), workshop.glossy(windows(), { roughness: 0.12 }),
      workshop.mesh(wheels), plate(workshop),
    ];
  return {
    size: [LENGTH, WIDTH], near, far: [workshop.mesh(merged([distant(colour), windows()]))],
    brakes: brakeLamps(), left: indicators(1), right: indicators(-1),
  };
}
