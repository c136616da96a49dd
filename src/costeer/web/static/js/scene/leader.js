/**
 * Leader: the car ahead, where the record says that it is.
 */

import { Car } from "./car.js";

/** Deceleration from which on brake lamps shine, and below which they go out [m/s²]. */
const BRAKES_ON = 0.6;
const BRAKES_OFF = 0.3;

export class Leader {
  /** @param {import("./workshop.js").Workshop} workshop */
  constructor(workshop, layout) {
    this.layout = layout;
    this.car = new Car(workshop, "#c9cfd4");
    this.car.group.visible = false;
    this.last = null;
    this.isBraking = false;
  }

  /**
   * Put it where it is.
   * @param {{distance: number, lane: number, velocity: number, time: number}} state
   *   distance between the cars' middles [m]; NaN without a leader
   */
  update({ distance, lane, velocity, time }) {
    const isThere = Number.isFinite(distance) && Number.isFinite(lane);
    this.car.group.visible = isThere;
    if (!isThere) {
      this.last = null;
      return;
    }
    this.car.group.position.set(distance, this.layout.centre(lane), 0);
    this.brake(velocity, time);
  }

  brake(velocity, time) {
    const step = this.last ? time - this.last.time : Number.POSITIVE_INFINITY;
    // Steps that are too short tell noise, those that are long tell nothing.
    if (step >= 0 && step < 0.1) return;
    if (step < 1 && step > 0) {
      const deceleration = (this.last.velocity - velocity) / step;
      this.isBraking = deceleration > (this.isBraking ? BRAKES_OFF : BRAKES_ON);
    } else {
      this.isBraking = false;
    }
    this.car.braking = this.isBraking;
    this.last = { velocity, time };
  }
}
