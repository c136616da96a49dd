/**
 * Smoothing: softens edges after drawing, for machines without a graphics card.
 *
 * Drawing with several samples costs such a machine half of its pictures; this looks at
 * each point's neighbours once, and only blends where they differ (after FXAA, Lottes 2009).
 */

import {
  FramebufferTexture, LinearFilter, Mesh, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial, Vector2,
} from "../../vendor/three.module.js";

const VERTEX = "void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }";

const FRAGMENT = `
uniform sampler2D picture;
uniform vec2 texel;
uniform ivec2 most;
const vec3 LUMA = vec3(0.299, 0.587, 0.114);
vec3 at(vec2 place) { return texture2D(picture, place).rgb; }
float near(ivec2 point, ivec2 step) {
  return dot(texelFetch(picture, clamp(point + step, ivec2(0), most), 0).rgb, LUMA);
}
void main() {
  vec2 here = gl_FragCoord.xy * texel;
  ivec2 point = ivec2(gl_FragCoord.xy);
  vec3 own = texelFetch(picture, point, 0).rgb;
  float middle = dot(own, LUMA);
  float nw = near(point, ivec2(-1, 1));
  float ne = near(point, ivec2(1, 1));
  float sw = near(point, ivec2(-1, -1));
  float se = near(point, ivec2(1, -1));
  float low = min(middle, min(min(nw, ne), min(sw, se)));
  float high = max(middle, max(max(nw, ne), max(sw, se)));
  gl_FragColor = vec4(own, 1.0);
  if (high - low < max(0.04, 0.1 * high)) return;
  vec2 along = vec2((sw + se) - (nw + ne), (nw + sw) - (ne + se));
  float least = min(abs(along.x), abs(along.y)) + max(0.03 * (nw + ne + sw + se), 0.008);
  along = clamp(along / least, -4.0, 4.0) * texel;
  vec3 close = 0.5 * (at(here - along / 6.0) + at(here + along / 6.0));
  vec3 wide = 0.5 * close + 0.25 * (at(here - 0.5 * along) + at(here + 0.5 * along));
  float bright = dot(wide, LUMA);
  gl_FragColor.rgb = bright < low || bright > high ? close : wide;
}`;

export class Smoothing {
  constructor() {
    this.texture = null;
    this.uniforms = { picture: { value: null }, texel: { value: new Vector2() }, most: { value: new Vector2() } };
    this.material = new ShaderMaterial({
      uniforms: this.uniforms, vertexShader: VERTEX, fragmentShader: FRAGMENT,
      depthTest: false, depthWrite: false,
    });
    this.camera = new OrthographicCamera();
    this.scene = new Scene();
    const sheet = new Mesh(new PlaneGeometry(2, 2), this.material);
    sheet.frustumCulled = false;
    this.scene.add(sheet);
  }

  fit({ x, y }) {
    this.texture?.dispose();
    this.texture = new FramebufferTexture(x, y);
    this.texture.minFilter = this.texture.magFilter = LinearFilter;
    this.uniforms.picture.value = this.texture;
    this.uniforms.texel.value.set(1 / x, 1 / y);
    this.uniforms.most.value.set(x - 1, y - 1);
  }

  /** Soften what has been drawn. */
  apply(renderer, size) {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2());
    if (this.texture?.image.width !== x || this.texture.image.height !== y) this.fit({ x, y });
    renderer.copyFramebufferToTexture(this.texture);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, size.width, size.height);
    renderer.render(this.scene, this.camera);
  }
}
