/**
 * Course: the road around the car, in axes along the road where the car is.
 *
 * Long things (road, rails, hedges, trees) are built along a straight line and bent while
 * they are drawn; single things (cars, signs, bridges) are put to their place. Both use one
 * table of the line, so that they fit. On a straight road nothing is bent.
 */

import { DataTexture, FloatType, NearestFilter, RGBAFormat } from "../../vendor/three.module.js";
import { AHEAD, BEHIND } from "./layout.js";

/** Between two points of the table [m]: 4 mm beside an arc of 200 m. */
const STEP = 2.5;
const FIRST = -BEHIND - 50;
const COUNT = (AHEAD - FIRST) / STEP + 42;

/** Axes of three are the road's: x is -z, y is -x (axes.js). */
const BENT = `
uniform sampler2D roadLine;
vec3 bent(vec3 place) {
  float along = clamp((-place.z - (${FIRST.toFixed(1)})) / ${STEP.toFixed(1)}, 0.0, ${(COUNT - 1.01).toFixed(2)});
  int n = int(along);
  vec4 line = mix(
    texelFetch(roadLine, ivec2(n, 0), 0), texelFetch(roadLine, ivec2(n + 1, 0), 0), along - float(n)
  );
  return vec3(-(line.y - line.z * place.x), place.y, -(line.x + line.w * place.x));
}
`;

const PLACED = `
vec4 mvPosition = vec4(transformed, 1.0);
#ifdef USE_INSTANCING
  mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelMatrix * mvPosition;
mvPosition.xyz = bent(mvPosition.xyz);
mvPosition = viewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;
`;

export class Course {
  /** @param {import("./alignment.js").Alignment} alignment */
  constructor(alignment) {
    this.alignment = alignment;
    this.isStraight = alignment.isStraight;
    this.position = Number.NaN;
    this.origin = { x: 0, y: 0, heading: 0 };
    /** Of each point x, y, cosine and sine of the direction. */
    this.line = new Float32Array(4 * COUNT);
    this.texture = new DataTexture(this.line, COUNT, 1, RGBAFormat, FloatType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
  }

  /** Take the axes along to a place of the car [m]. */
  moveTo(position) {
    if (position === this.position) return;
    this.position = position;
    this.origin = this.alignment.place(position);
    if (this.isStraight) return;
    const [c, s] = [Math.cos(this.origin.heading), Math.sin(this.origin.heading)];
    for (let n = 0; n < COUNT; n++) {
      const { x, y, heading } = this.alignment.place(position + FIRST + n * STEP);
      const [dx, dy] = [x - this.origin.x, y - this.origin.y];
      const turn = heading - this.origin.heading;
      this.line.set([c * dx + s * dy, c * dy - s * dx, Math.cos(turn), Math.sin(turn)], 4 * n);
    }
    this.texture.needsUpdate = true;
  }

  /** Place and direction of what is `ahead` of the car along the road and `y` across it. */
  at(ahead, y) {
    if (this.isStraight) return { x: ahead, y, heading: 0 };
    const along = Math.min(Math.max((ahead - FIRST) / STEP, 0), COUNT - 1.01);
    const n = Math.floor(along);
    const [x0, y0, c, s] = [0, 1, 2, 3].map((k) => {
      const before = this.line[4 * n + k];
      return before + (along - n) * (this.line[4 * n + 4 + k] - before);
    });
    return { x: x0 - s * y, y: y0 + c * y, heading: Math.atan2(s, c) };
  }

  /** Put a group there. */
  put(group, ahead, y) {
    const place = this.at(ahead, y);
    group.position.set(place.x, place.y, 0);
    group.rotation.z = place.heading;
  }

  /**
   * Have a material drawn along the road.
   * @param {import("../../vendor/three.module.js").Material} material
   * @param {string} [placed] how a vertex comes to its place, if not as usual
   */
  bend(material, placed = PLACED) {
    const isUsual = placed === PLACED;
    if (this.isStraight && isUsual) return material;
    material.onBeforeCompile = (shader) => {
      shader.uniforms.roadLine = { value: this.texture };
      shader.vertexShader = (this.isStraight ? "vec3 bent(vec3 p) { return p; }\n" : BENT)
        + shader.vertexShader.replace("#include <project_vertex>", placed);
    };
    material.customProgramCacheKey = () => `${this.isStraight} ${placed}`;
    return material;
  }
}
