/**
 * World: everything outside the car, in axes that go along the road with the car.
 *
 * The car stays at x = 0 and the road moves: far along a course the numbers would
 * otherwise get too coarse for single precision.
 */

import { Fog, Group, Scene } from "../../vendor/three.module.js";
import { roadAxes } from "./axes.js";
import { Car } from "./car.js";
import { buildLandmarks } from "./landmarks.js";
import { PERIOD, layoutOf } from "./layout.js";
import { Leader } from "./leader.js";
import { OWN_BODY } from "./mirrors.js";
import { buildRoad } from "./road.js";
import { buildRoadside } from "./roadside.js";
import { HAZE, buildSky } from "./sky.js";

export class World {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {object} road of the hello
   * @param {string} colour of the own car
   */
  constructor(workshop, road, colour) {
    this.scene = new Scene();
    this.scene.fog = new Fog(HAZE, 200, 2000);
    const axes = roadAxes();
    this.scene.add(axes);
    this.layout = layoutOf(road);
    this.roadside = buildRoadside(workshop, this.layout);
    this.landmarks = buildLandmarks(workshop, this.layout);
    this.repeating = new Group();
    this.repeating.add(buildRoad(workshop, this.layout), this.roadside.fixed);
    this.leader = new Leader(workshop, this.layout);
    this.sky = buildSky(workshop.low);
    /** The own car; cameras and mirrors hang on it. */
    this.car = new Group();
    const body = new Car(workshop, colour).group;
    body.traverse((part) => part.layers.set(OWN_BODY));
    this.car.add(body);
    axes.add(
      this.sky, this.repeating, this.landmarks.group, this.leader.car.group, this.car,
      ...workshop.lights(),
    );
  }

  /**
   * Bring it up to date.
   * @param {{position: number, lateral: number, yaw: number, leader: object}} state
   *   place along and across the road [m], heading, left positive [rad]
   */
  update({ position, lateral, yaw, leader }) {
    this.repeating.position.x = -(((position % PERIOD) + PERIOD) % PERIOD);
    this.roadside.update(position);
    this.landmarks.update(position);
    this.car.position.y = lateral;
    this.car.rotation.z = yaw;
    this.sky.position.y = lateral;
    this.leader.update(leader);
  }
}
