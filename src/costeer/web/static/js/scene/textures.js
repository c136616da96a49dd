/**
 * Textures, drawn here: nothing is loaded.
 */

import { CanvasTexture, RepeatWrapping, SRGBColorSpace } from "../../vendor/three.module.js";
import { stream } from "./random.js";

/**
 * A canvas and its pen. It is painted by the processor: what goes to a texture would
 * otherwise have to come back from the graphics card first.
 */
export function canvas(width, height) {
  const element = document.createElement("canvas");
  element.width = width;
  element.height = height;
  return { element, pen: element.getContext("2d", { willReadFrequently: true }) };
}

/** A texture of a canvas. */
export function textureOf(element, { repeat = false, sharpness = 1 } = {}) {
  const texture = new CanvasTexture(element);
  texture.colorSpace = SRGBColorSpace;
  texture.anisotropy = sharpness;
  if (repeat) texture.wrapS = texture.wrapT = RepeatWrapping;
  return texture;
}

/** Sprinkle grains of many shades over a canvas. */
export function grain(pen, area, count, tones, seed, size = 1) {
  const next = stream(seed);
  for (let n = 0; n < count; n++) {
    pen.fillStyle = tones[Math.floor(next() * tones.length)];
    const [x, y, s] = [next() * area.width, next() * area.height, size * (0.5 + next())];
    pen.fillRect(x, y, s, s);
  }
}

/** Soft blobs that wrap around, for worn and grown places. */
export function blobs(pen, area, count, colour, seed, radius) {
  const next = stream(seed);
  for (let n = 0; n < count; n++) {
    const [x, y, r] = [next() * area.width, next() * area.height, radius * (0.4 + next())];
    for (const dx of [-area.width, 0, area.width]) {
      for (const dy of [-area.height, 0, area.height]) {
        const fade = pen.createRadialGradient(x + dx, y + dy, 0, x + dx, y + dy, r);
        fade.addColorStop(0, colour);
        fade.addColorStop(1, "rgba(0,0,0,0)");
        pen.fillStyle = fade;
        pen.fillRect(x + dx - r, y + dy - r, 2 * r, 2 * r);
      }
    }
  }
}

/** Grass seen from a driver's height: shades of green that repeat without a seam. */
export function grassTexture(sharpness) {
  const { element, pen } = canvas(512, 512);
  pen.fillStyle = "#6b8348";
  pen.fillRect(0, 0, 512, 512);
  blobs(pen, element, 40, "rgba(120,135,70,0.35)", 11, 90);
  blobs(pen, element, 40, "rgba(62,92,48,0.4)", 12, 80);
  const tones = ["#5c7a3e", "#748c4c", "#88995a", "#4f6c38", "#7d9152"];
  grain(pen, element, 26000, tones, 13, 2.2);
  return textureOf(element, { repeat: true, sharpness });
}

/** A crown of leaves, clump over clump, darker below. */
function crown(pen, next, { x, y, width, height, hue, clumps }) {
  for (let n = 0; n < clumps; n++) {
    const angle = next() * 2 * Math.PI;
    const reach = Math.sqrt(next());
    const cx = x + (Math.cos(angle) * reach * width) / 2;
    const cy = y + (Math.sin(angle) * reach * height) / 2;
    const light = 25 + 17 * (0.5 - (cy - y) / height) + 9 * next() - 5 * ((cx - x) / width);
    pen.fillStyle = `hsl(${hue + 16 * next()} ${24 + 9 * next()}% ${light}%)`;
    pen.beginPath();
    const r = 3 + width * (0.014 + 0.03 * next());
    pen.ellipse(cx, cy, r, r * 0.8, next() * 3, 0, 2 * Math.PI);
    pen.fill();
  }
}

/** A broad-leaved tree. */
function broadTree(pen, next) {
  pen.fillStyle = "#4c3f33";
  pen.fillRect(122, 165, 12, 91);
  crown(pen, next, { x: 128, y: 175, width: 120, height: 80, hue: 84, clumps: 420 });
  crown(pen, next, { x: 128, y: 112, width: 206, height: 180, hue: 80, clumps: 1500 });
}

/** A cedar: layers of branches that narrow to the top. */
function cedar(pen, next) {
  pen.fillStyle = "#46372c";
  pen.fillRect(123, 210, 10, 46);
  for (let layer = 0; layer < 15; layer++) {
    const share = layer / 15;
    const width = 26 + 120 * (1 - share);
    const y = 225 - 208 * share;
    crown(pen, next, { x: 128, y, width, height: 34, hue: 105, clumps: 130 });
  }
}

/** A group of bushes, as wide as high again. */
function bushes(pen, next) {
  for (const [x, width, height] of [[60, 110, 110], [190, 120, 90], [125, 140, 130]]) {
    crown(pen, next, { x, y: 256 - height * 0.42, width, height, hue: 76, clumps: 700 });
  }
}

/** Leaves of a clipped hedge. */
export function hedgeTexture(sharpness) {
  const { element, pen } = canvas(256, 256);
  pen.fillStyle = "#3d5531";
  pen.fillRect(0, 0, 256, 256);
  grain(pen, element, 9000, ["#4b673b", "#5b7a45", "#33482a", "#6b8650", "#445f36"], 14, 5);
  return textureOf(element, { repeat: true, sharpness });
}

const PLANTS = [broadTree, cedar, bushes];

/** Textures of the plants: broad tree, cedar, bushes. */
export function plantTextures() {
  return PLANTS.map((paint, kind) => {
    const { element, pen } = canvas(256, 256);
    paint(pen, stream(31 + kind));
    return textureOf(element);
  });
}

/** A soft dark spot: the shadow under a car. */
export function shadowTexture() {
  const { element, pen } = canvas(128, 64);
  for (let n = 0; n < 22; n++) {
    pen.fillStyle = "rgba(0,0,0,0.055)";
    pen.beginPath();
    pen.roundRect(n * 1.1, n, 128 - 2.2 * n, 64 - 2 * n, 14);
    pen.fill();
  }
  return textureOf(element);
}

/** Panels of a sound wall: light metal, with a post at the seam. */
export function wallTexture(sharpness) {
  const { element, pen } = canvas(256, 256);
  const shade = pen.createLinearGradient(0, 0, 0, 256);
  shade.addColorStop(0, "#c3c8c6");
  shade.addColorStop(1, "#9fa5a2");
  pen.fillStyle = shade;
  pen.fillRect(0, 0, 256, 256);
  for (let y = 0; y < 256; y += 64) {
    pen.fillStyle = "rgba(0,0,0,0.20)";
    pen.fillRect(0, y, 256, 2);
    for (let k = 8; k < 64; k += 7) {
      pen.fillStyle = "rgba(0,0,0,0.07)";
      pen.fillRect(14, y + k, 230, 2);
    }
  }
  pen.fillStyle = "#7f8684";
  pen.fillRect(0, 0, 10, 256);
  return textureOf(element, { repeat: true, sharpness });
}
