/**
 * One question each, as a field: `element`, `names`, `raw()` and `write(raw)` for the
 * draft, `values()` to send, `problems()` by item, `mark(text)`, `focus()`.
 *
 * All text comes from data and goes into text nodes, never into markup.
 */

import { make } from "../elements.js";
import { words } from "./words.js";

/** Scales with more places than this are a row of ticks. */
const MOST_POINTS = 11;

/**
 * The field of an item that is no comparison.
 * @param {object} item as `rendered` of instrument.py gives it
 * @param {string} id begins the ids of its elements
 * @param {Record<string, string>} texts
 */
export function makeField(item, id, texts) {
  if (item.kind === "scale") return scaleField(item, id, texts);
  if (item.kind === "choice") return radioField(item, id, texts, item.options, "choices");
  if (item.kind === "yes_no" && item.must_agree) return agreementField(item, id, texts);
  if (item.kind === "yes_no") return radioField(item, id, texts, item.options, "choices");
  return writtenField(item, id, texts);
}

/** The star behind a question that needs an answer; said in words to who hears it. */
export function star(item, texts) {
  if (!item.required) return [];
  const said = make("span", { class: "unseen" }, ` (${words(texts, "form_required")})`);
  return [make("span", { class: "star", "aria-hidden": "true" }, "\u00a0*"), said];
}

/** Place for what is wrong with an answer. */
export function errorPlace(id) {
  return make("p", { class: "error", id: `${id}-error`, hidden: true });
}

/** Title and question, and the star. */
function heading(item, texts) {
  const parts = [];
  if (item.title) parts.push(make("span", { class: "title" }, item.title));
  if (item.title && item.text) parts.push(" ");
  if (item.text) parts.push(make("span", { class: "text" }, item.text));
  return [...parts, ...star(item, texts)];
}

function valuesOf(scale) {
  const count = Math.round((scale.high - scale.low) / scale.step) + 1;
  return Array.from({ length: count }, (_, n) => scale.low + n * scale.step);
}

/** A scale: answers in words, numbered points, or a row of ticks. Nothing is preset. */
function scaleField(item, id, texts) {
  const values = valuesOf(item);
  const count = values.length;
  const isLabelled = values.every((value) => item.labels[String(value)]);
  const look = isLabelled ? "choices" : count > MOST_POINTS ? "ticks" : "points";
  const isNumbered = item.step === 1 && item.low >= 0;
  const options = values.map((value, n) => ({
    value,
    label: isLabelled ? item.labels[String(value)] : null,
    said: words(texts, "scale_place", { number: isNumbered ? value : n + 1,
      count: isNumbered ? item.high : count }),
    number: isNumbered && (look === "points" || value % 5 === 0) ? String(value) : "",
  }));
  return radioField(item, id, texts, options, look);
}

/** Radio buttons: what a keyboard, a mouse, a finger and a screen reader know already. */
function radioField(item, id, texts, options, look) {
  const error = errorPlace(id);
  const radios = options.map(({ value, label, said }) =>
    make("input", { type: "radio", name: id, value: String(value),
      ...(label === null ? { "aria-label": said } : {}) }));
  const places = options.map(({ label, number }, n) =>
    make("label", { class: "place" }, radios[n],
      make("span", { class: "face", ...(label === null ? { "aria-hidden": "true" } : {}) },
        label ?? number)));
  const row = make("div", { class: `row ${look}` }, ...places);
  if (look === "ticks") followFinger(row, radios);
  if (look === "choices") row.style.setProperty("--least", `${widthOf(options)}em`);
  const parts = [row];
  const described = [error.id];
  if (item.low_text && look !== "choices") {
    const said = words(texts, "scale_from_to", { low: item.low_text, high: item.high_text });
    parts.push(make("div", { class: "ends", "aria-hidden": "true" },
      make("span", {}, item.low_text), make("span", {}, item.high_text)));
    parts.push(make("span", { class: "unseen", id: `${id}-ends` }, said));
    described.unshift(`${id}-ends`);
  }
  const isBipolar = !item.title && !item.text;
  const legend = make("legend", { id: `${id}-legend`, class: isBipolar ? "unseen" : "" },
    ...(isBipolar ? [`${item.low_text} – ${item.high_text}`, ...star(item, texts)]
      : heading(item, texts)));
  const element = make("fieldset",
    { class: `question of-${look}${isBipolar ? " bipolar" : ""}`, role: "radiogroup",
      "aria-labelledby": legend.id, "aria-describedby": described.join(" "),
      "aria-required": String(item.required) },
    legend, make("div", { class: "scale" }, ...parts), error);
  const chosen = () => options[radios.findIndex((radio) => radio.checked)]?.value;
  return {
    element,
    names: [item.name],
    raw: () => ({ [item.name]: chosen() }),
    write: (raw) => {
      const n = options.findIndex(({ value }) => value === raw[item.name]);
      if (n >= 0) radios[n].checked = true;
    },
    values: () => (chosen() === undefined ? {} : { [item.name]: chosen() }),
    problems: () => (item.required && chosen() === undefined ? { [item.name]: "missing" } : {}),
    mark: (text) => mark(element, error, text),
    focus: () => (radios.find((radio) => radio.checked) ?? radios[0]).focus(),
  };
}

/** Width at which all answers stand side by side, in two lines at most [em], about. */
function widthOf(options) {
  const longest = Math.max(...options.flatMap(({ label }) =>
    [label.length / 2, ...label.split(/[\s-]+/).map((word) => word.length)]));
  return options.length * (longest * 0.56 + 1);
}

/** Let a finger or pointer slide along narrow ticks. */
function followFinger(row, radios) {
  row.addEventListener("pointermove", (event) => {
    if (!(event.buttons & 1)) return;
    const { left, width } = row.getBoundingClientRect();
    const place = Math.floor(((event.clientX - left) / width) * radios.length);
    const radio = radios[Math.min(Math.max(place, 0), radios.length - 1)];
    if (!radio.checked) radio.click();
  });
  // A drag that ends elsewhere is no drag of the page's text.
  row.addEventListener("dragstart", (event) => event.preventDefault());
}

/** Something to agree to: a box to tick. */
function agreementField(item, id, texts) {
  const error = errorPlace(id);
  const box = make("input", { type: "checkbox", id, "aria-describedby": error.id,
    "aria-required": "true" });
  const label = make("label", { class: "agreement" }, box, make("span", {}, ...heading(item, texts)));
  const element = make("div", { class: "question of-agreement" }, label, error);
  return {
    element,
    names: [item.name],
    raw: () => ({ [item.name]: box.checked ? "yes" : null }),
    write: (raw) => { box.checked = raw[item.name] === "yes"; },
    values: () => (box.checked ? { [item.name]: "yes" } : {}),
    problems: () => (box.checked ? {} : { [item.name]: "must_agree" }),
    mark: (text) => mark(box, error, text),
    focus: () => box.focus(),
  };
}

/** A number or a text, written. */
function writtenField(item, id, texts) {
  const error = errorPlace(id);
  const isNumber = item.kind === "number";
  const isLong = !isNumber && item.longest > 80;
  const input = make(isLong ? "textarea" : "input",
    { id, "aria-describedby": error.id, "aria-required": String(item.required),
      autocomplete: "off", ...(isLong ? { rows: 4 } : { type: "text" }),
      ...(isNumber ? { inputMode: "decimal", class: "number" } : {}),
      ...(!isNumber && item.longest <= 10 ? { class: "brief" } : {}) });
  const label = make("label", { htmlFor: id }, ...heading(item, texts));
  const element = make("div", { class: "question of-writing" }, label, input, error);
  const value = () => {
    const text = input.value.trim();
    return isNumber && text ? Number(text.normalize("NFKC").replace(",", ".")) : text;
  };
  return {
    element,
    names: [item.name],
    raw: () => ({ [item.name]: input.value }),
    write: (raw) => { if (typeof raw[item.name] === "string") input.value = raw[item.name]; },
    values: () => (value() === "" ? {} : { [item.name]: value() }),
    problems: () => {
      const code = value() === "" ? item.required && "missing"
        : isNumber ? wrongNumber(item, value())
          : [...value()].length > item.longest && "too_long";
      return code ? { [item.name]: code } : {};
    },
    mark: (text) => mark(input, error, text),
    focus: () => input.focus(),
  };
}

function wrongNumber(item, value) {
  if (!Number.isFinite(value)) return "not_a_number";
  if (value < item.low || value > item.high) return "out_of_range";
  const steps = (value - item.low) / item.step;
  return Math.abs(steps - Math.round(steps)) > 1e-6 && "off_step";
}

/** Say what is wrong beside a question; nothing if the text is empty. */
export function mark(control, error, text) {
  error.textContent = text;
  error.hidden = !text;
  if (text) control.setAttribute("aria-invalid", "true");
  else control.removeAttribute("aria-invalid");
}
