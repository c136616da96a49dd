/** Elements of the page, made from words. */

/**
 * An element with attributes and children.
 * @param {string} name
 * @param {Record<string, unknown>} attributes `class`, properties, or `on...` listeners
 * @param {...(Node|string)} children
 */
export function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "class") element.className = value;
    else if (key in element) element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/** The element of the page with an id. */
export function byId(id) {
  return document.getElementById(id);
}

/** A number for people: a dash where there is none. */
export function shownNumber(value, digits, unit = "") {
  if (!Number.isFinite(value)) return "–";
  const text = value.toFixed(digits).replace(/^-(?=[0.]*$)/, ""); // no -0.0
  return `${text}${unit ? ` ${unit}` : ""}`;
}
