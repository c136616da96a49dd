/** Comparisons of two, one at a time: a field like those of items.js. */

import { make } from "../elements.js";
import { errorPlace, mark, star } from "./items.js";
import { words } from "./words.js";

/**
 * The field of all comparisons of an instrument.
 * @param {object[]} pairs in the order in which they are shown
 * @param {object[]} items all items, for the questions behind the names
 * @param {string} id begins the ids of its elements
 * @param {Record<string, string>} texts
 */
export function makePairs(pairs, items, id, texts) {
  const questions = new Map(items.map((item) => [item.name, item.text]));
  const chosen = new Map();
  let at = 0;

  const error = errorPlace(id);
  const heading = make("h2", { id: `${id}-heading` }, pairs[0].text, ...star(pairs[0], texts));
  const place = make("p", { class: "progress", role: "status", tabIndex: -1 });
  const sides = [0, 1].map((side) => make("button",
    { type: "button", class: "side", onclick: () => choose(side) }));
  const row = make("div", { class: "sides" }, ...sides);
  const hint = make("p", { class: "hint" }, words(texts, "pairs_keys"));
  const back = make("button", { type: "button", class: "quiet",
    onclick: () => { at -= 1; show(); sides[0].focus(); } }, words(texts, "pairs_back"));
  const element = make("section", { class: "question of-pairs", role: "group",
    "aria-labelledby": heading.id, "aria-describedby": error.id,
    onkeydown: followKeys }, heading, place, row,
    make("div", { class: "foot" }, back, hint), error);

  function followKeys(event) {
    const side = { ArrowLeft: 0, ArrowRight: 1 }[event.key];
    if (side === undefined || event.repeat || at >= pairs.length) return;
    event.preventDefault();
    sides[side].focus();
    choose(side);
  }

  function choose(side) {
    chosen.set(pairs[at].name, pairs[at].options[side].value);
    at = nextOpen();
    show();
    if (at >= pairs.length) place.focus();
    element.dispatchEvent(new Event("input", { bubbles: true }));
  }

  /** The next comparison without an answer, behind this one or from the beginning. */
  function nextOpen() {
    const isOpen = (pair) => !chosen.has(pair.name);
    const behind = pairs.findIndex((pair, n) => n > at && isOpen(pair));
    if (behind >= 0) return behind;
    const any = pairs.findIndex(isOpen);
    return any >= 0 ? any : pairs.length;
  }

  function show() {
    const isDone = at >= pairs.length;
    row.hidden = isDone;
    hint.hidden = isDone;
    back.hidden = at === 0;
    if (isDone) {
      place.textContent = words(texts, "pairs_done", { count: pairs.length });
      return;
    }
    const { name, options } = pairs[at];
    const both = options.map(({ label }) => label).join(" – ");
    place.replaceChildren(
      words(texts, "pairs_place", { number: at + 1, count: pairs.length }),
      make("span", { class: "unseen" }, `: ${both}`));
    options.forEach(({ value, label }, side) => {
      sides[side].replaceChildren(make("strong", {}, label), " ",
        make("span", {}, questions.get(value) ?? ""));
      sides[side].setAttribute("aria-pressed", String(chosen.get(name) === value));
    });
  }

  show();
  return {
    element,
    names: pairs.map((pair) => pair.name),
    raw: () => Object.fromEntries(chosen),
    write: (raw) => {
      for (const { name, options } of pairs) {
        if (options.some(({ value }) => value === raw[name])) chosen.set(name, raw[name]);
      }
      at = -1;
      at = nextOpen();
      show();
    },
    values: () => Object.fromEntries(chosen),
    problems: () => Object.fromEntries(pairs
      .filter((pair) => pair.required && !chosen.has(pair.name))
      .map((pair) => [pair.name, "missing"])),
    mark: (text) => mark(element, error, text),
    focus: () => (row.hidden ? place : sides[0]).focus(),
  };
}
