/**
 * Panel of the experimenter: condition, method, gains, restart, and figures of the link.
 */

import { byId, make, shownNumber } from "./elements.js";

function choice(label, names, chosen, onchoice) {
  const select = make("select", {
    onchange: () => {
      onchoice(select.value);
      select.blur();
    },
  });
  select.append(...names.map((name) => make("option", { value: name }, name)));
  select.value = chosen;
  return { element: make("label", {}, label, select), select };
}

/** A slider with a field: both show the same number. */
function tunable({ name, unit, low, high, value, label }, onset) {
  const limits = { min: low, max: high, step: (high - low) / 200 };
  const slider = make("input", { type: "range", ...limits, "aria-label": label ?? name });
  const field = make("input", { type: "number", ...limits, step: "any", "aria-label": label ?? name });
  const show = (number) => {
    slider.value = String(number);
    field.value = String(Number(Number(number).toPrecision(4)));
  };
  const set = (text) => {
    const number = Math.min(Math.max(Number.parseFloat(text), low), high);
    if (!Number.isFinite(number)) return;
    show(number);
    onset(name, number);
  };
  slider.addEventListener("input", () => {
    field.value = slider.value;
  });
  slider.addEventListener("change", () => {
    set(slider.value);
    slider.blur();
  });
  field.addEventListener("change", () => set(field.value));
  show(value);
  const text = unit && unit !== "-" ? `${label ?? name} [${unit}]` : (label ?? name);
  const row = make("div", { class: "row" }, slider, field);
  return { element: make("div", {}, make("label", {}, text), row), show, name };
}

const FIGURES = [
  ["rate", "picture rate"], ["frames", "state rate"], ["input", "input to state, p95"],
  ["wheel", "wheel to page, p95"], ["lateness", "lateness of the loop"],
  ["compute", "control step"],
];

export class Panel {
  /** @param {import("./protocol.js").Link} link */
  constructor(hello, link) {
    this.element = byId("panel");
    this.link = link;
    this.condition = choice("Condition", hello.conditions ?? [], hello.condition, (name) =>
      link.send({ type: "set", name: "condition", value: name }),
    );
    this.method = choice("Method", hello.methods ?? [], hello.method, (name) =>
      link.send({ type: "set", name: "method", value: name }),
    );
    this.tunables = (hello.tunables ?? []).map((one) =>
      tunable(one, (name, value) => link.send({ type: "set", name, value })),
    );
    this.figures = Object.fromEntries(FIGURES.map(([name]) => [name, make("dd", {}, "–")]));
    this.element.replaceChildren(
      make("h2", {}, "Experimenter"), this.condition.element, this.method.element,
      ...this.tunables.map((one) => one.element), this.buttons(), this.figureList(),
    );
    this.element.hidden = false;
  }

  buttons() {
    const send = (type) => (event) => {
      this.link.send({ type });
      event.currentTarget.blur();
    };
    return make("p", { class: "row" },
      make("button", { type: "button", onclick: send("restart") }, "Restart"),
      make("button", { type: "button", onclick: send("stop") }, "Stop"),
    );
  }

  figureList() {
    const lines = FIGURES.flatMap(([name, label]) => [make("dt", {}, label), this.figures[name]]);
    return make("dl", {}, ...lines);
  }

  toggle() {
    this.element.hidden = !this.element.hidden;
  }

  /** Show what the server now uses. */
  state({ condition, method, tunables }) {
    if (condition) this.condition.select.value = condition;
    if (method) this.method.select.value = method;
    for (const { name, value } of tunables ?? []) {
      const one = this.tunables.find((each) => each.name === name);
      if (one && !one.element.contains(document.activeElement)) one.show(value);
    }
  }

  /** Show the figures: rates [Hz], latencies [ms], lateness and computing time [s]. */
  show({ fps, frameRate, latency, lateness, computeTime }) {
    this.figures.rate.textContent = shownNumber(fps, 0, "Hz");
    this.figures.frames.textContent = shownNumber(frameRate, 0, "Hz");
    this.figures.input.textContent = shownNumber(latency.input.p95, 1, "ms");
    this.figures.wheel.textContent = shownNumber(latency.wheel.p95, 1, "ms");
    this.figures.lateness.textContent = shownNumber(lateness * 1000, 2, "ms");
    this.figures.compute.textContent = shownNumber(computeTime * 1000, 2, "ms");
  }
}
