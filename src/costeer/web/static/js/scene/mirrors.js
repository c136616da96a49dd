/**
 * Mirrors: the centre mirror and one at each door.
 *
 * Each is drawn by a camera that looks back, onto a texture that is then shown with left
 * and right exchanged, as in a mirror.
 */

import {
  AlwaysDepth, Group, HalfFloatType, LinearFilter, Matrix4, PerspectiveCamera, PlaneGeometry, Shape, Vector3,
  UnsignedByteType, WebGLRenderTarget,
} from "../../vendor/three.module.js";
import { aim } from "./axes.js";
import { EYE_FORWARD, verticalEdges } from "./eye.js";
import { box, coloured, drawnOut } from "./geometry.js";

/** Layer of the own car's body: only the door mirrors see it. */
export const OWN_BODY = 1;

const RADIAN = Math.PI / 180;

/** Width of a mirror's frame and its distance to the view's edge, 1 m away [m]. */
const RIM = 0.009;
const MARGIN = 0.012;

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/**
 * Mirrors, the most useful first. Bearings are where they hang as the eye sees them [deg],
 * left positive; where the screen is narrower they move to its edge. `inner` exchanges the
 * sides for left-hand drive.
 */
function plans(inner) {
  return [
    {
      bearing: inner * 33, elevation: 9, width: 12.5, height: 3.6, fov: 22, outward: 0,
      from: [0.5, 0, 1.3], seesBody: false,
    },
    {
      bearing: -inner * 42, elevation: -4.4, width: 7.4, height: 5, fov: 26, outward: -inner * 11,
      from: [0.75, -inner * 0.98, 1.0], seesBody: true,
    },
    {
      bearing: inner * 58, elevation: -4.4, width: 7.4, height: 5, fov: 26, outward: inner * 11,
      from: [0.75, inner * 0.98, 1.0], seesBody: true,
    },
  ];
}

function roundedRectangle(width, height, radius) {
  const shape = new Shape();
  const [w, h] = [width / 2, height / 2];
  shape.moveTo(-w + radius, -h);
  shape.lineTo(w - radius, -h);
  shape.quadraticCurveTo(w, -h, w, -h + radius);
  shape.lineTo(w, h - radius);
  shape.quadraticCurveTo(w, h, w - radius, h);
  shape.lineTo(-w + radius, h);
  shape.quadraticCurveTo(-w, h, -w, h - radius);
  shape.lineTo(-w, -h + radius);
  shape.quadraticCurveTo(-w, -h, -w + radius, -h);
  return shape;
}

class Mirror {
  constructor(workshop, plan, pixels) {
    this.plan = plan;
    this.width = 2 * Math.tan((plan.width * RADIAN) / 2);
    this.height = 2 * Math.tan((plan.height * RADIAN) / 2);
    const aspect = this.width / this.height;
    this.target = new WebGLRenderTarget(pixels, Math.round(pixels / aspect), {
      type: workshop.low ? UnsignedByteType : HalfFloatType, minFilter: LinearFilter, samples: workshop.low ? 0 : 4,
    });
    const tall = (2 * Math.atan(Math.tan((plan.fov * RADIAN) / 2) / aspect)) / RADIAN;
    this.camera = new PerspectiveCamera(tall, aspect, 0.5, 4500);
    this.camera.position.set(...plan.from);
    // In car axes from the centre of gravity, as the eye is.
    this.camera.position.x += EYE_FORWARD;
    aim(this.camera, Math.PI - plan.outward * RADIAN, 0.02);
    if (plan.seesBody) this.camera.layers.enable(OWN_BODY);
    this.mesh = this.hung(workshop);
  }

  /** The mirror as it hangs before the eye. */
  hung(workshop) {
    const glass = new PlaneGeometry(this.width, this.height);
    const { uv } = glass.attributes;
    for (let n = 0; n < uv.count; n++) uv.setX(n, 1 - uv.getX(n));
    const back = drawnOut(
      roundedRectangle(this.width + 2 * RIM, this.height + 2 * RIM, 0.02), 0.002,
    ).applyMatrix4(new Matrix4().makeRotationX(-Math.PI / 2));
    const shell = workshop.mesh(coloured(back, "#15181b"));
    shell.position.z = -0.0012;
    const mesh = new Group();
    const picture = workshop.plain(glass, { map: this.target.texture });
    this.target.texture.minFilter = LinearFilter;
    const arm = workshop.mesh(this.arm());
    arm.position.z = -0.003;
    mesh.add(arm, shell, picture);
    // In a narrow view they hang before the pillars, so nothing may hide them.
    [arm, shell, picture].forEach((part, order) => {
      part.renderOrder = 10 + order;
      part.material.depthFunc = AlwaysDepth;
    });
    return mesh;
  }

  /** What bears it: the centre mirror hangs from the roof, the others stand at the doors. */
  arm() {
    const { seesBody, bearing } = this.plan;
    if (!seesBody) return box([0.022, 0.3, 0.001], [0, this.height / 2 + 0.15, 0], "#1b1e21");
    const towards = Math.sign(bearing) * (this.width / 2 + 0.03);
    return box([0.09, 0.035, 0.001], [towards, -this.height * 0.36, 0], "#15181b");
  }

  /**
   * Hang it where it belongs, or at the edge of a narrower view.
   * @param {{yaw: number, left: number, unit: number}[]} planes of the screens
   * @param {number} top tangent of a screen's upper edge
   */
  fit(planes, top) {
    const wanted = this.plan.bearing * RADIAN;
    const distance = ({ yaw }) => Math.abs(yaw - wanted);
    const plane = planes.reduce((a, b) => (distance(b) < distance(a) ? b : a));
    // Places on the screen's plane, at distance 1; left is positive.
    const [low, high] = [-plane.left - plane.unit, -plane.left];
    const room = this.width / 2 + RIM + MARGIN;
    const across = clamp(Math.tan(clamp(wanted - plane.yaw, -1.4, 1.4)), low + room, high - room);
    const wish = Math.tan(this.plan.elevation * RADIAN) / Math.cos(wanted - plane.yaw);
    this.place(plane.yaw, across, Math.min(wish, top - this.height / 2 - RIM - MARGIN));
  }

  /** Hang it parallel to the screen's plane, so that it is a rectangle there. */
  place(yaw, across, height) {
    const ahead = new Vector3(Math.cos(yaw), Math.sin(yaw), 0);
    const left = new Vector3(-Math.sin(yaw), Math.cos(yaw), 0);
    const up = new Vector3(0, 0, 1);
    this.mesh.position.copy(ahead).addScaledVector(left, across).setZ(height);
    const axes = new Matrix4().makeBasis(left.negate(), up, ahead.negate());
    this.mesh.quaternion.setFromRotationMatrix(axes);
  }
}

export class Mirrors {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {number} count of mirrors
   * @param {number} inner side of the car's middle, seen from the driver
   */
  constructor(workshop, count, inner) {
    this.group = new Group();
    /** Cameras live in the car's axes. */
    this.cameras = new Group();
    const pixels = workshop.low ? 256 : 640;
    this.all = plans(inner).slice(0, count).map((plan) => new Mirror(workshop, plan, pixels));
    for (const mirror of this.all) {
      this.group.add(mirror.mesh);
      this.cameras.add(mirror.camera);
    }
    this.turn = 0;
    this.isLow = workshop.low;
  }

  /** Hang the mirrors into the view through these screens. */
  fit(planes, aspect) {
    const { top } = verticalEdges(planes[0].unit, aspect);
    for (const mirror of this.all) mirror.fit(planes, top);
  }

  /** Draw what the mirrors show: all of them, in low quality one at a time. */
  render(renderer, scene) {
    // The centre mirror every second time, those at the doors in turn.
    const next = this.turn % 2 === 0 ? 0 : 1 + (((this.turn - 1) / 2) % Math.max(1, this.all.length - 1));
    this.turn += 1;
    const all = this.isLow ? this.all.slice(next, next + 1) : this.all;
    for (const mirror of all) {
      renderer.setRenderTarget(mirror.target);
      renderer.clear();
      renderer.render(scene, mirror.camera);
    }
    renderer.setRenderTarget(null);
  }
}
