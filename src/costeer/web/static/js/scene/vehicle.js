/**
 * Vehicle: one of the others on the road, with lamps that tell what it does.
 */

import { Group, Mesh, MeshBasicMaterial, PlaneGeometry } from "../../vendor/three.module.js";
import { carParts } from "./car.js";
import { isLit } from "./dashboard.js";
import { hash } from "./random.js";
import { shadowTexture } from "./textures.js";
import { obstacleParts, truckParts } from "./truck.js";

const COLOURS = ["#c9cfd4", "#23272b", "#8c1d22", "#f1f2f0", "#5f666c", "#244a78", "#70776f", "#b9a88a"];
const BUILDERS = { car: carParts, truck: truckParts, obstacle: obstacleParts };

/** Distance from which on a vehicle is drawn with fewer parts [m]. */
const FAR = 90;

/** Deceleration from which on brake lamps shine, and below which they go out [m/s²]. */
const BRAKES_ON = 0.6;
const BRAKES_OFF = 0.3;

/** Lateral speed of a car that changes lanes [m/s], and how long its indicator outlives it [s]. */
const CHANGES = 0.25;
const OUTLIVES = 0.5;

const LAMPS = {
  brakeOff: "#7a1016", brakeOn: "#ff2a22", indicatorOff: "#6b4a1c", indicatorOn: "#ffb01f",
};

/** The parts of a kind in a colour; many vehicles share them. */
function partsOf(workshop, kind, colour) {
  return workshop.once(`${kind} ${colour}`, () => BUILDERS[kind](workshop, colour));
}

const again = (mesh) => new Mesh(mesh.geometry, mesh.material);

function shadow(workshop, [length, width]) {
  const look = { map: workshop.once("shadow", shadowTexture), transparent: true, depthWrite: false, fog: false };
  const mesh = workshop.plain(new PlaneGeometry(length * 1.14, width * 1.4), look);
  // Towards the side away from the sun.
  mesh.position.set(0.12, -0.15, 0.02);
  return mesh;
}

export class Vehicle {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {[string, number, number]} kind with length and width [m]
   * @param {number} number picks its colour
   */
  constructor(workshop, [kind, length, width], number) {
    const colour = COLOURS[Math.floor(hash(number, 97) * COLOURS.length)];
    this.build(workshop, partsOf(workshop, kind in BUILDERS ? kind : "car", colour), [length, width]);
    this.last = null;
    this.isBraking = false;
    this.side = 0;
    this.sideSince = Number.NEGATIVE_INFINITY;
  }

  build(workshop, parts, [length, width]) {
    this.group = new Group();
    this.near = new Group();
    this.far = new Group();
    this.near.add(...parts.near.map(again), shadow(workshop, parts.size));
    this.far.add(...parts.far.map(again));
    this.lamps = workshop.once("lamps", () => Object.fromEntries(
      Object.entries(LAMPS).map(([name, color]) => [name, new MeshBasicMaterial({ color })]),
    ));
    const lamp = (geometry, material) => new Mesh(geometry, material);
    if (parts.brakes) {
      this.brakes = lamp(parts.brakes, this.lamps.brakeOff);
      this.left = lamp(parts.left, this.lamps.indicatorOff);
      this.right = lamp(parts.right, this.lamps.indicatorOff);
      this.group.add(this.brakes, this.left, this.right);
    }
    this.group.add(this.near, this.far);
    this.group.scale.set(length / parts.size[0], width / parts.size[1], 1);
    this.group.visible = false;
  }

  /** It is not there. */
  hide() {
    this.group.visible = false;
    this.last = null;
  }

  /**
   * Put it where it is.
   * @param {import("./course.js").Course} course
   * @param {{ahead: number, lateral: number, velocity: number, time: number}} state
   *   distance between the middles [m], from the left lane's centre [m]; time of the trial [s]
   */
  update(course, { ahead, lateral, velocity, time }) {
    this.group.visible = true;
    course.put(this.group, ahead, lateral);
    const isNear = Math.abs(ahead) < FAR;
    this.near.visible = isNear;
    this.far.visible = !isNear;
    if (!this.brakes) return;
    this.watch(lateral, velocity, time);
    const { brakeOn, brakeOff, indicatorOn, indicatorOff } = this.lamps;
    const lit = isLit(time);
    this.brakes.material = this.isBraking ? brakeOn : brakeOff;
    this.left.material = lit && this.side > 0 ? indicatorOn : indicatorOff;
    this.right.material = lit && this.side < 0 ? indicatorOn : indicatorOff;
  }

  /** Tell from its motion whether it brakes and changes lanes. */
  watch(lateral, velocity, time) {
    const step = this.last ? time - this.last.time : Number.POSITIVE_INFINITY;
    // Steps that are too short tell noise, those that are long tell nothing.
    if (step >= 0 && step < 0.1) return;
    if (step < 1 && step > 0) {
      const deceleration = (this.last.velocity - velocity) / step;
      this.isBraking = deceleration > (this.isBraking ? BRAKES_OFF : BRAKES_ON);
      const speed = (lateral - this.last.lateral) / step;
      if (Math.abs(speed) > CHANGES) [this.side, this.sideSince] = [Math.sign(speed), time];
      else if (time - this.sideSince > OUTLIVES) this.side = 0;
    } else {
      [this.isBraking, this.side] = [false, 0];
    }
    this.last = { lateral, velocity, time };
  }
}
