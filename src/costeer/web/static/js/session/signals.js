/** Live signals on the console: the last half minute, or what was zoomed to. */

import uPlot from "../../vendor/uPlot.esm.js";
import { make, shownNumber } from "../elements.js";
import { Columns } from "../frames.js";
import { Link, socketAddress } from "../protocol.js";

/** Time on show [s], and between two points and two paintings. */
const SPAN = 30;
const SPACING = 1 / 30;
const REFRESH = 0.12;

const DEGREE = 180 / Math.PI;
const CHARTS = [
  { name: "wheel angle", unit: "°", digits: 1, least: 10,
    signals: [{ column: "steering_wheel_angle", factor: DEGREE }] },
  { name: "torque", unit: "N·m", digits: 2, least: 1, signals: [
    { column: "driver_torque", factor: 1, label: "driver" },
    { column: "applied_torque", factor: 1, label: "guidance" },
  ] },
  { name: "haptic gain", unit: "", digits: 2, limits: [-0.03, 1.03], none: "no guidance",
    signals: [{ column: "haptic_gain", factor: 1 }] },
  { name: "speed", unit: "km/h", digits: 0, around: 5,
    signals: [{ column: "longitudinal_velocity", factor: 3.6 }] },
  { name: "lateral position", unit: "m", digits: 2, least: 1,
    signals: [{ column: "lateral_position", factor: 1 }] },
];
const SIGNALS = CHARTS.flatMap((chart) => chart.signals);

/** Follows the drive that is on and draws it. */
export class Signals {
  /**
   * @param {HTMLElement} parent
   * @param {string} query tokens for the socket
   */
  constructor(parent, query) {
    this.parent = parent;
    this.query = query;
    this.link = null;
    this.columns = null;
    this.lastFrame = null;
    this.zoomed = null;
    this.painted = 0;
    this.clear();
    this.back = make("button", { type: "button", class: "live", hidden: true,
      onclick: () => this.zoom(null) }, "Live again");
    this.build();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    new ResizeObserver(() => this.resize()).observe(parent);
    requestAnimationFrame((time) => this.draw(time));
  }

  /** Hold a socket exactly as long as a drive is on. */
  follow(drive) {
    if (drive === this.drive) return;
    this.drive = drive;
    this.link?.close();
    this.link = null;
    this.lastFrame = null;
    if (!drive) return;
    this.clear();
    this.zoom(null);
    this.link = new Link(socketAddress(location, this.query), {
      hello: (hello) => {
        this.columns = new Columns(hello.columns, hello.stepped);
      },
      frames: (buffer) => this.receive(buffer),
      text: (message) => {
        if (message.type === "farewell") this.link?.close();
      },
      closed: () => {},
    });
  }

  clear() {
    this.times = [];
    this.series = SIGNALS.map(() => []);
    this.isNew = true;
  }

  receive(buffer) {
    if (!this.columns) return;
    for (const frame of this.columns.split(buffer)) {
      this.lastFrame = frame;
      this.push(this.columns.value(frame, "time"), frame);
    }
  }

  /** Keep a frame; a standing clock adds nothing. */
  push(time, frame) {
    const newest = this.times.at(-1) ?? Number.NEGATIVE_INFINITY;
    if (time < newest) this.clear();
    else if (time - newest < SPACING * 0.9) return;
    this.times.push(time);
    SIGNALS.forEach(({ column, factor }, n) => {
      const value = this.columns.shown(frame, column) * factor;
      this.series[n].push(Number.isFinite(value) ? value : null);
    });
    const old = this.times.findIndex((one) => one >= time - SPAN - 1);
    if (old > 60 && !this.zoomed) {
      for (const list of [this.times, ...this.series]) list.splice(0, old);
    }
    this.isNew = true;
  }

  /** A column of the newest frame, NaN without one. */
  value(name) {
    return this.lastFrame ? this.columns.value(this.lastFrame, name) : Number.NaN;
  }

  /** Show a range of times [s] and stay there; null follows the drive again. */
  zoom(range) {
    this.zoomed = range;
    this.isNew = true;
    if (this.back) this.back.hidden = !range;
  }

  build() {
    for (const plot of this.plots ?? []) plot.destroy();
    this.values = CHARTS.map((chart) => chart.signals.map(() =>
      make("span", { class: "value" }, "–")));
    const rows = CHARTS.map((chart, n) => make("div", { class: "chart" },
      make("div", { class: "name" }, nameOf(chart), ...this.values[n].map((value, k) =>
        make("span", { class: k ? "second" : "first" }, value))),
      make("div", { class: "plot" })));
    this.parent.replaceChildren(this.back, ...rows);
    this.plots = CHARTS.map((chart, n) => {
      const place = rows[n].lastElementChild;
      return new uPlot(this.options(chart, n), [[], ...chart.signals.map(() => [])], place);
    });
    this.resize();
    this.isNew = true;
  }

  options(chart, n) {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--dim"), grid: { stroke: colour("--grid"), width: 1 },
      ticks: { stroke: colour("--grid"), width: 1, size: 3 }, font: "12px system-ui, sans-serif" };
    return {
      width: 300, height: 60, padding: [8, 16, n < CHARTS.length - 1 ? 8 : 0, 0],
      legend: { show: false },
      cursor: { sync: { key: "console" }, y: false, points: { size: 6 },
        drag: { x: true, y: false, setScale: false } },
      scales: { x: { time: false, range: () => this.range() },
        y: { range: (_, low, high) => limitsOf(chart, low, high) } },
      axes: [
        { ...axis, show: n === CHARTS.length - 1, size: 20, values: (_, all) => all.map((t) => `${t} s`) },
        { ...axis, size: 42, space: 20 },
      ],
      series: [{}, ...chart.signals.map((_, k) => ({
        stroke: colour(k ? "--two" : "--one"), width: 2, points: { show: false },
      }))],
      hooks: {
        setCursor: [() => this.showValues()],
        setSelect: [(plot) => this.selected(plot)],
      },
    };
  }

  selected(plot) {
    const { left, width } = plot.select;
    if (width < 5) return;
    this.zoom([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  }

  range() {
    if (this.zoomed) return this.zoomed;
    const end = Math.max(this.times.at(-1) ?? 0, SPAN);
    return [end - SPAN, end];
  }

  resize() {
    this.plots.forEach((plot) => {
      const { clientWidth: width, clientHeight: height } = plot.root.parentElement;
      if (width > 0 && height > 20) plot.setSize({ width, height });
    });
  }

  draw(time) {
    requestAnimationFrame((next) => this.draw(next));
    if (!this.isNew || time / 1000 - this.painted < REFRESH) return;
    this.painted = time / 1000;
    this.isNew = false;
    let first = 0;
    this.plots.forEach((plot, n) => {
      const count = CHARTS[n].signals.length;
      plot.setData([this.times, ...this.series.slice(first, first + count)]);
      first += count;
    });
    this.showValues();
  }

  /** The values under the cursor, else the newest. */
  showValues() {
    if (!this.values) return;
    const hovered = this.plots?.[0].cursor.idx;
    const place = hovered ?? this.times.length - 1;
    let signal = 0;
    CHARTS.forEach(({ signals, digits, none }, n) => signals.forEach(({ label }, k) => {
      const value = this.series[signal++][place] ?? Number.NaN;
      const isNone = none && place >= 0 && !Number.isFinite(value);
      const text = isNone ? none : shownNumber(value, digits);
      this.values[n][k].replaceChildren(text, make("small", {}, label ? ` ${label}` : ""));
    }));
  }
}

function nameOf({ name, unit }) {
  return unit ? `${name} [${unit}]` : name;
}

/** Limits of a chart's values: never so narrow that noise looks like a signal. */
function limitsOf({ limits, least, around }, low, high) {
  if (limits) return limits;
  if (around) return [(low ?? 0) - around, (high ?? 100) + around];
  return [Math.min(-least, low ?? 0), Math.max(least, high ?? 0)];
}
