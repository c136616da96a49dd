/**
 * Workshop: meshes in the quality that the machine can draw.
 *
 * In low quality nothing is lit while drawing: the light is painted into the vertices.
 */

import {
  DirectionalLight, HemisphereLight, InstancedMesh, LinearMipmapNearestFilter, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial,
} from "../../vendor/three.module.js";
import { SUN, shaded } from "./geometry.js";

export class Workshop {
  /**
   * @param {boolean} low
   * @param {number} sharpness highest anisotropy of textures
   * @param {import("./course.js").Course|null} course along which all is bent, if it is
   */
  constructor(low, sharpness, course = null) {
    this.low = low;
    this.course = course;
    this.kept = new Map();
    /** Anisotropy of textures on the ground; without a graphics card each step costs. */
    this.sharpness = low ? 1 : sharpness;
    this.roadSharpness = low ? 2 : sharpness;
  }

  /** A mesh of coloured geometry; it may carry a texture. */
  mesh(geometry, settings = {}) {
    const look = this.thrifty({ vertexColors: true, ...settings });
    if (!this.low) return this.laid(new Mesh(geometry, new MeshLambertMaterial(look)));
    return this.laid(new Mesh(shaded(geometry), new MeshBasicMaterial(look)));
  }

  /** A mesh along the road, where that bends: nobody knows beforehand where it will be. */
  laid(mesh) {
    if (!this.course || this.course.isStraight) return mesh;
    this.course.bend(mesh.material);
    mesh.frustumCulled = false;
    return mesh;
  }

  /** What is built once and used by many. */
  once(name, build) {
    if (!this.kept.has(name)) this.kept.set(name, build());
    return this.kept.get(name);
  }

  /** Many of one kind: room for a number of copies, of which none is shown yet. */
  copies(geometry, most, settings = {}) {
    const one = this.mesh(geometry, settings);
    const many = new InstancedMesh(one.geometry, one.material, most);
    many.count = 0;
    many.frustumCulled = false;
    return many;
  }

  /** A mesh that reflects the sky: car paint and glass. */
  glossy(geometry, { roughness = 0.35, metalness = 0.1 } = {}) {
    if (this.low) return this.mesh(geometry);
    const look = { vertexColors: true, roughness, metalness };
    return new Mesh(geometry, new MeshStandardMaterial(look));
  }

  /** A mesh that shines by itself: signs, lamps, instruments, sky. */
  plain(geometry, settings = {}) {
    return new Mesh(geometry, new MeshBasicMaterial(this.thrifty(settings)));
  }

  /** In low quality textures are taken from one size, not blended from two. */
  thrifty(settings) {
    if (this.low && settings.map) settings.map.minFilter = LinearMipmapNearestFilter;
    return settings;
  }

  /** The lights of a scene, for those that are lit. */
  lights() {
    if (this.low) return [];
    const sun = new DirectionalLight("#fff3df", 2.1);
    sun.position.copy(SUN).multiplyScalar(100);
    const sky = new HemisphereLight("#e6e8ea", "#8d8f83", 1.25);
    sky.position.set(0, 0, 1);
    return [sun, sky];
  }
}
