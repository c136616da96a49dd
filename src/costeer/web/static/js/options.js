/**
 * What the page's address asks for: `?low`, `?full`, `?screens=3`, `?fov=140`, ...
 */

/** Horizontal view of the whole set of screens [deg], by number of screens. */
const USUAL_FOV = { 1: 70, 2: 100, 3: 140 };

/**
 * A number from the address, kept within a range.
 * @param {URLSearchParams} query
 * @param {string} name
 * @param {number} usual used where the address says nothing or nonsense
 * @param {number} low
 * @param {number} high
 */
function number(query, name, usual, low, high) {
  const value = Number.parseFloat(query.get(name) ?? "");
  return Number.isFinite(value) ? Math.min(Math.max(value, low), high) : usual;
}

/** Whether a switch such as `?low` is on. */
function flag(query, name) {
  return query.has(name) && !["0", "false", "no"].includes(query.get(name));
}

/** Whether the browser draws with the processor alone. */
export function rendersInSoftware() {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return true;
  const details = context.getExtension("WEBGL_debug_renderer_info");
  const name = context.getParameter(details ? details.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(String(name));
}

/**
 * Options of the page.
 * @param {string} search `location.search`
 * @returns {{low: boolean, screens: number, fov: number, isFovGiven: boolean,
 *   angle: number|null, mirrors: number, scale: number|null, counters: boolean, isMuted: boolean}} `fov` and
 *   `angle` in degrees; `angle` lies between the planes of neighbouring screens, null where
 *   they stand around the eye.
 */
export function readOptions(search) {
  const query = new URLSearchParams(search);
  const low = flag(query, "low") || (!flag(query, "full") && rendersInSoftware());
  const screens = Math.round(number(query, "screens", 1, 1, 3));
  return {
    low,
    screens,
    fov: number(query, "fov", USUAL_FOV[screens], 20, 179 * (screens > 1 ? 1 : 0.9)),
    isFovGiven: query.has("fov") || screens > 1,
    angle: query.has("angle") ? number(query, "angle", 0, 0, 90) : null,
    mirrors: Math.round(number(query, "mirrors", 3, 0, 3)),
    scale: query.has("scale") ? number(query, "scale", 1, 0.2, 3) : null,
    counters: !flag(query, "clean"),
    isMuted: flag(query, "mute"),
  };
}

/** The part of the address that is passed on to the server: its tokens. */
export function credentials(search) {
  const query = new URLSearchParams(search);
  const kept = new URLSearchParams();
  for (const name of ["token", "experimenter"]) {
    if (query.has(name)) kept.set(name, query.get(name));
  }
  const text = kept.toString();
  return text ? `?${text}` : "";
}
