/**
 * World: everything outside the car, in axes that go along the road with the car.
 *
 * The car stays at x = 0 and the road moves: far along a course the numbers would
 * otherwise get too coarse for single precision.
 */

import { Fog, Group, Scene } from "../../vendor/three.module.js";
import { Alignment } from "./alignment.js";
import { roadAxes } from "./axes.js";
import { carParts } from "./car.js";
import { Course } from "./course.js";
import { buildLandmarks } from "./landmarks.js";
import { PERIOD, layoutOf } from "./layout.js";
import { buildMarks } from "./marks.js";
import { OWN_BODY } from "./mirrors.js";
import { ribbons } from "./ribbon.js";
import { buildFields, buildRoad } from "./road.js";
import { buildRoadside } from "./roadside.js";
import { HAZE, buildSky } from "./sky.js";
import { grassTexture } from "./textures.js";
import { Traffic } from "./traffic.js";
import { Workshop } from "./workshop.js";

export class World {
  /**
   * @param {import("./workshop.js").Workshop} workshop
   * @param {object} hello of the server: road, scenario, other cars
   * @param {string} colour of the own car
   */
  constructor(workshop, hello, colour) {
    this.scene = new Scene();
    this.scene.fog = new Fog(HAZE, 200, 2000);
    const axes = roadAxes();
    this.scene.add(axes);
    this.course = new Course(new Alignment(hello.scenario?.stations));
    this.layout = {
      ...layoutOf(hello.road, hello.scenario), ribbon: ribbons(this.course.isStraight),
    };
    /** What turns with the sky while the road bends. */
    this.heaven = new Group();
    this.heaven.add(buildSky(workshop.low), ...workshop.lights());
    this.buildRoad(workshop, hello.scenario?.speed_limit);
    this.marks = buildMarks(workshop, this.course, this.layout, hello);
    this.traffic = new Traffic(workshop, this.layout, hello);
    /** The own car; cameras and mirrors hang on it. */
    this.car = new Group();
    const body = carParts(workshop, colour)[workshop.low ? "far" : "near"];
    for (const part of body) part.layers.set(OWN_BODY);
    this.car.add(...body);
    axes.add(
      this.heaven, this.fields.mesh, this.repeating, this.landmarks.group, this.marks.group,
      this.traffic.group, this.car,
    );
  }

  buildRoad(workshop, limit) {
    const along = new Workshop(workshop.low, workshop.sharpness, this.course);
    along.roadSharpness = workshop.roadSharpness;
    const grass = grassTexture(workshop.sharpness);
    this.fields = buildFields(workshop, grass);
    this.roadside = buildRoadside(along, this.layout);
    this.landmarks = buildLandmarks(workshop, this.course, this.layout, limit);
    this.repeating = new Group();
    this.repeating.add(buildRoad(along, this.layout, grass), this.roadside.fixed);
  }

  /**
   * Bring it up to date.
   * @param {(name: string) => number} value of a column, NaN where there is none
   */
  update(value) {
    const finite = (name) => value(name) || 0;
    const position = finite("longitudinal_position");
    this.course.moveTo(position);
    this.repeating.position.x = -(((position % PERIOD) + PERIOD) % PERIOD);
    this.fields.update(this.course.origin);
    this.roadside.update(position);
    this.landmarks.update(position);
    this.marks.update(position);
    this.car.position.y = this.heaven.position.y = finite("lateral_position");
    this.car.rotation.z = finite("yaw_angle");
    this.heaven.rotation.z = -this.course.origin.heading;
    this.traffic.update(this.course, value);
  }
}
