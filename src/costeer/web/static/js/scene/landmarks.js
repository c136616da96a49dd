/**
 * Landmarks: plates with the distance at every 100 m and a bridge now and then.
 */

import { CircleGeometry, Group, PlaneGeometry } from "../../vendor/three.module.js";
import { box, merged } from "./geometry.js";
import { canvas, textureOf } from "./textures.js";

/** Speed-limit signs: the first, and from one to the next [m]. */
const FIRST_SIGN = 120;
const SIGN_SPACING = 1000;

const PLATE_SPACING = 100;
const PLATES = 4;
const BRIDGE_SPACING = 1700;
const FIRST_BRIDGE = 850;

/** A green plate on a post, with a number that can change. */
class Plate {
  constructor(workshop) {
    this.face = canvas(128, 96);
    this.texture = textureOf(this.face.element, { sharpness: 4 });
    this.group = new Group();
    const face = workshop.plain(new PlaneGeometry(0.62, 0.46), { map: this.texture });
    // It faces back along the road.
    face.rotation.set(Math.PI / 2, -Math.PI / 2, 0, "XYZ");
    face.position.set(-0.03, 0, 1.62);
    const post = box([0.05, 0.05, 1.9], [0, 0, 0.9], "#b9bfc2");
    this.group.add(face, workshop.mesh(post));
    this.number = null;
  }

  write(number) {
    if (number === this.number) return;
    this.number = number;
    const { pen } = this.face;
    pen.fillStyle = "#0f6b43";
    pen.fillRect(0, 0, 128, 96);
    pen.strokeStyle = pen.fillStyle = "#f5f7f5";
    pen.lineWidth = 4;
    pen.strokeRect(4, 4, 120, 88);
    pen.font = "600 50px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText((number / 10).toFixed(1), 64, 51);
    this.texture.needsUpdate = true;
  }
}

/** A road bridge over both carriageways. */
function bridge(layout) {
  const o = layout.outer;
  const [near, far] = [layout.outerBarrier, layout.oppositeFar - o * layout.verge];
  const middle = (near + far) / 2;
  const span = Math.abs(near - far) + 24;
  const concrete = "#b4b3ac";
  const pier = (y) => box([1.1, 0.9, 6], [0, y, 3], concrete);
  return merged([
    box([9, span, 1.0], [0, middle, 6.1], concrete),
    box([9.4, span, 0.25], [0, middle, 6.7], "#a3a29b"),
    box([0.12, span, 0.9], [-4.5, middle, 7.2], "#c5c9c8"),
    box([0.12, span, 0.9], [4.5, middle, 7.2], "#c5c9c8"),
    pier((layout.innerPaved + layout.opposite) / 2),
    box([8, 3, 8], [0, near + o * 7, 2.4], "#a5a49c"),
    box([8, 3, 8], [0, far - o * 7, 2.4], "#a5a49c"),
  ]);
}

/** A round sign with a red ring and the speed limit, on a post. */
function limitSign(workshop, [number, unit]) {
  const { element, pen } = canvas(256, 256);
  for (const [radius, colour] of [[127, "#f5f5f2"], [122, "#c4161c"], [94, "#f8f8f5"]]) {
    pen.fillStyle = colour;
    pen.beginPath();
    pen.arc(128, 128, radius, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.fillStyle = "#14294f";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.font = `700 ${number > 99 ? 96 : 118}px system-ui, sans-serif`;
  pen.fillText(String(number), 128, unit ? 118 : 134);
  pen.font = "700 34px system-ui, sans-serif";
  if (unit) pen.fillText(unit, 128, 186);
  const face = workshop.plain(new CircleGeometry(0.5, 40), { map: textureOf(element, { sharpness: 4 }) });
  face.rotation.set(Math.PI / 2, -Math.PI / 2, 0, "XYZ");
  face.position.set(-0.05, 0, 2.5);
  const post = merged([
    box([0.07, 0.07, 2.9], [0, 0, 1.4], "#a9afb2"), box([0.02, 0.5, 0.5], [-0.02, 0, 2.5], "#8d9497"),
  ]);
  const sign = new Group();
  sign.add(face, workshop.mesh(post));
  return sign;
}

/** Signs along the road, two of which are in sight. */
function limitSigns(workshop, course, layout, limit) {
  const signs = limit ? [0, 1].map(() => limitSign(workshop, limit)) : [];
  const y = layout.outerBarrier + layout.outer * 0.9;
  const update = (position) => {
    const next = Math.max(0, Math.ceil((position - FIRST_SIGN - 60) / SIGN_SPACING));
    signs.forEach((sign, n) => {
      const ahead = FIRST_SIGN + (next + n) * SIGN_SPACING - position;
      sign.visible = ahead < 700;
      course.put(sign, ahead, y);
    });
  };
  return { signs, update };
}

/**
 * @returns {{group: Group, update: (position: number) => void}} in axes whose origin moves
 *   along the road with the car
 */
export function buildLandmarks(workshop, course, layout, limit) {
  const group = new Group();
  const limits = limitSigns(workshop, course, layout, limit);
  for (const sign of limits.signs) group.add(sign);
  const plates = Array.from({ length: PLATES }, () => new Plate(workshop));
  const bridges = [0, 1].map(() => workshop.mesh(bridge(layout)));
  group.add(...plates.map((plate) => plate.group), ...bridges);
  const y = layout.outerBarrier + layout.outer * 0.6;
  const update = (position) => {
    const first = Math.floor((position - 20) / PLATE_SPACING) + 1;
    for (let n = 0; n < PLATES; n++) {
      const plate = plates[(((first + n) % PLATES) + PLATES) % PLATES];
      plate.write(first + n);
      plate.group.visible = first + n >= 0;
      course.put(plate.group, (first + n) * PLATE_SPACING - position, y);
    }
    limits.update(position);
    const next = Math.floor((position - FIRST_BRIDGE - 200) / BRIDGE_SPACING) + 1;
    bridges.forEach((mesh, n) => {
      course.put(mesh, FIRST_BRIDGE + (next + n) * BRIDGE_SPACING - position, 0);
    });
  };
  return { group, update };
}
