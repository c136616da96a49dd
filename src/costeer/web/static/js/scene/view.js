/**
 * View: draws the world and the cockpit, for one to three screens.
 */

import { Group, PMREMGenerator, Scene, WebGLRenderer } from "../../vendor/three.module.js";
import { roadAxes } from "./axes.js";
import { Cockpit } from "./cockpit.js";
import {
  EYE_FORWARD, EYE_HEIGHT, EYE_OFFSET, frame, screenCamera, screenPlanes, widened,
} from "./eye.js";
import { Mirrors } from "./mirrors.js";
import { HAZE, buildSky } from "./sky.js";
import { Pace } from "./pace.js";
import { Smoothing } from "./smoothing.js";
import { Workshop } from "./workshop.js";
import { World } from "./world.js";

const OWN_COLOUR = "#2f4a63";

/**
 * Shape of a window for which the usual field of view holds [-]. In a flatter one, as above
 * the signals, more is shown at the sides instead of less above and below.
 */
const USUAL_ASPECT = 16 / 9;

/** Part of the depth buffer that the cockpit takes [-]. */
const NEAR_DEPTH = 0.05;

/** What a graphics card draws of every picture. */
const FULL = { mirrorsEvery: 1, isSmooth: true };

/** Most pixels that are drawn in low quality; the browser enlarges the picture. */
const MOST_PIXELS = 640 * 360;

export class View {
  /**
   * @param {HTMLElement} parent
   * @param {object} hello first message of the server
   * @param {ReturnType<import("../options.js").readOptions>} options
   */
  constructor(parent, hello, options) {
    this.parent = parent;
    this.options = options;
    this.renderer = new WebGLRenderer({
      antialias: !options.low, powerPreference: "high-performance",
    });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(HAZE);
    parent.prepend(this.renderer.domElement);
    const workshop = new Workshop(options.low, this.renderer.capabilities.getMaxAnisotropy());
    // Under left-hand traffic the driver sits on the right.
    const inner = hello.road.overtaking_side > 0 ? -1 : 1;
    this.world = new World(workshop, hello, OWN_COLOUR);
    this.cockpit = new Cockpit(workshop, inner, OWN_COLOUR);
    this.mirrors = new Mirrors(workshop, options.mirrors, inner);
    this.setUpCockpit(workshop);
    this.smoothing = options.low ? new Smoothing() : null;
    this.pace = options.low ? new Pace() : null;
    this.drawn = 0;
    if (!options.low) this.reflectSky();
    this.setUpScreens(inner);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(parent);
    this.resize();
  }

  /** Make room for another view. */
  close() {
    this.observer.disconnect();
    this.renderer.domElement.remove();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  setUpCockpit(workshop) {
    this.inside = new Scene();
    const axes = roadAxes();
    this.inside.add(axes);
    this.eyeAxes = new Group();
    axes.add(this.eyeAxes, this.cockpit.group, this.mirrors.group, ...workshop.lights());
  }

  /** Let car paint and glass reflect the sky. */
  reflectSky() {
    const generator = new PMREMGenerator(this.renderer);
    const scene = new Scene();
    const axes = roadAxes();
    scene.add(axes);
    axes.add(buildSky(true));
    const { texture } = generator.fromScene(scene, 0, 1, 9000);
    for (const lit of [this.world.scene, this.inside]) {
      lit.environment = texture;
      lit.environmentIntensity = 0.5;
    }
    generator.dispose();
  }

  setUpScreens(inner) {
    const { screens, fov, angle } = this.options;
    const eye = new Group();
    eye.position.set(EYE_FORWARD, -inner * EYE_OFFSET, EYE_HEIGHT);
    this.world.car.add(eye, this.mirrors.cameras);
    this.screens = screenPlanes(screens, fov, angle).map((plane) => {
      const [outside, inside] = [screenCamera(0.6, 9000), screenCamera(0.05, 20)];
      eye.add(outside);
      this.eyeAxes.add(inside);
      return { plane, outside, inside };
    });
  }

  resize() {
    const { clientWidth, clientHeight } = this.parent;
    const [width, height] = [Math.max(clientWidth, 1), Math.max(clientHeight, 1)];
    this.renderer.setPixelRatio(this.pixelRatio(width * height));
    this.renderer.setSize(width, height, false);
    this.size = { width, height };
    const aspect = width / this.screens.length / height;
    const widening = this.options.isFovGiven ? 1 : Math.max(1, aspect / USUAL_ASPECT);
    const planes = this.screens.map(({ plane }) => widened(plane, widening));
    this.screens.forEach(({ outside, inside }, n) => {
      frame(outside, planes[n], aspect);
      frame(inside, planes[n], aspect);
    });
    this.mirrors.fit(planes, aspect);
  }

  pixelRatio(pixels) {
    const { low, scale } = this.options;
    if (scale !== null) return scale;
    if (low) return Math.min(1, Math.sqrt(MOST_PIXELS / pixels));
    return Math.min(globalThis.devicePixelRatio || 1, 2);
  }

  /**
   * Take over a state.
   * @param {import("../frames.js").Columns} columns
   * @param {Float64Array} state
   */
  update(columns, state) {
    const value = (name) => columns.finite(state, name);
    this.world.update((name) => columns.value(state, name));
    this.cockpit.update({
      angle: value("steering_wheel_angle"),
      speed: value("longitudinal_velocity"),
      distance: value("longitudinal_position"),
      indicator: value("indicator"),
      time: performance.now() / 1000,
    });
  }

  /**
   * Draw. The cockpit comes first and takes the near part of the depth buffer: what it
   * hides of the world is then not drawn at all.
   */
  render() {
    const { renderer } = this;
    const context = renderer.getContext();
    context.depthRange(0, 1);
    const { mirrorsEvery, isSmooth } = this.pace?.tick(performance.now() / 1000) ?? FULL;
    if (this.drawn++ % mirrorsEvery === 0) this.mirrors.render(renderer, this.world.scene);
    const width = this.size.width / this.screens.length;
    renderer.setScissorTest(this.screens.length > 1);
    this.screens.forEach(({ outside, inside }, n) => {
      renderer.setViewport(n * width, 0, width, this.size.height);
      renderer.setScissor(n * width, 0, width, this.size.height);
      renderer.clear();
      context.depthRange(0, NEAR_DEPTH);
      renderer.render(this.inside, inside);
      context.depthRange(NEAR_DEPTH, 1);
      renderer.render(this.world.scene, outside);
    });
    context.depthRange(0, 1);
    if (isSmooth) this.smoothing?.apply(renderer, this.size);
  }
}
