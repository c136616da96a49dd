/**
 * Traffic: the other cars, where the frame says that they are.
 */

import { Group } from "../../vendor/three.module.js";
import { Vehicle } from "./vehicle.js";

const USUAL = ["car", 4.5, 1.8];

/** Furthest that a car is drawn, ahead and behind [m]. */
const SIGHT = { ahead: 1200, behind: 280 };

/** Numbers of cars in the names of a frame's columns. */
export function carsIn(names) {
  return names.map((name) => /^car_(\d+)_position$/.exec(name)?.[1]).filter(Boolean);
}

export class Traffic {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {object} layout
   * @param {object} hello of the server
   */
  constructor(workshop, layout, hello) {
    this.layout = layout;
    this.numbers = carsIn(hello.columns ?? []);
    const kinds = hello.other_cars ?? [];
    this.cars = this.numbers.map((_, n) => new Vehicle(workshop, kinds[n] ?? USUAL, n + 1));
    this.leader = new Vehicle(workshop, USUAL, 5);
    this.group = new Group();
    this.group.add(this.leader.group, ...this.cars.map((car) => car.group));
  }

  /**
   * Put all of them where they are.
   * @param {import("./course.js").Course} course
   * @param {(name: string) => number} value of a column, NaN where there is none
   */
  update(course, value) {
    const [time, position] = [value("time"), value("longitudinal_position")];
    const lane = value("lead_lane");
    this.place(this.leader, course, {
      ahead: value("lead_distance"), lateral: this.layout.centre(lane),
      velocity: value("lead_velocity"), time,
    });
    this.numbers.forEach((number, n) => {
      this.place(this.cars[n], course, {
        ahead: value(`car_${number}_position`) - position, lateral: value(`car_${number}_lateral`),
        velocity: value(`car_${number}_velocity`), time,
      });
    });
  }

  place(car, course, state) {
    const isThere = Number.isFinite(state.ahead) && Number.isFinite(state.lateral);
    const isSeen = isThere && state.ahead < SIGHT.ahead && state.ahead > -SIGHT.behind;
    if (isSeen) car.update(course, state);
    else car.hide();
  }
}
