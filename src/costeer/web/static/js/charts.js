/**
 * Charts of the signals: torques, gain and probability, mode and consistency.
 */

import uPlot from "../vendor/uPlot.esm.js";
import { make } from "./elements.js";

const stepped = uPlot.paths.stepped({ align: 1 });

/** What is drawn: one chart each. */
const CHARTS = [
  {
    title: "Torque [N·m]",
    signals: [
      { column: "driver_torque", label: "driver", stroke: "#57b8ff" },
      { column: "applied_torque", label: "guidance", stroke: "#ffb224" },
    ],
    range: (_, low, high) => [Math.min(-1, low ?? -1), Math.max(1, high ?? 1)],
  },
  {
    title: "Gain and probability [-]",
    signals: [
      { column: "haptic_gain", label: "gain K_h", stroke: "#4cc38a" },
      { column: "crossing_probability", label: "crossing", stroke: "#e26ce0" },
    ],
    range: () => [-0.03, 1.03],
  },
  {
    title: "Mode and consistency",
    signals: [
      // Broad and below the other: the two often lie on one another.
      { column: "consistent", label: "consistent (0, 1)", stroke: "#2f7d59", paths: stepped, width: 5 },
      { column: "mode", label: "mode", stroke: "#e9eef2", paths: stepped },
    ],
    range: () => [-0.1, 2.1],
    splits: [0, 1, 2],
    names: ["manual", "keep", "change"],
  },
];

const GRID = { stroke: "rgba(255,255,255,0.07)", width: 1 };
const TICKS = { stroke: "rgba(255,255,255,0.12)", width: 1, size: 4 };
const AXIS = { stroke: "#a3b0ba", grid: GRID, ticks: TICKS, font: "11px system-ui, sans-serif" };

/** Columns that are drawn. */
export const DRAWN = CHARTS.flatMap((chart) => chart.signals.map((signal) => signal.column));

function optionsOf(chart, size, xRange) {
  const names = chart.names;
  return {
    ...size,
    title: chart.title,
    cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
    legend: { live: false },
    scales: { x: { time: false, range: xRange }, y: { range: chart.range } },
    axes: [
      { ...AXIS, size: 22, values: (_, splits) => splits.map((t) => `${t}`) },
      {
        ...AXIS,
        size: names ? 58 : 42,
        ...(chart.splits ? { splits: () => chart.splits } : { space: 22 }),
        ...(names ? { values: () => names } : {}),
      },
    ],
    series: [{}, ...chart.signals.map(({ label, stroke, paths, width = 1.6 }) => ({
      label, stroke, paths, width, points: { show: false }, spanGaps: false,
    }))],
  };
}

/** A row of charts over the same time. */
export class Charts {
  /**
   * @param {HTMLElement} parent
   * @param {(u: uPlot, low: number, high: number) => number[]} xRange limits of the time axis
   */
  constructor(parent, xRange) {
    this.parent = parent;
    this.places = CHARTS.map(() => make("div", { class: "chart" }));
    parent.replaceChildren(...this.places);
    const empty = (chart) => [[], ...chart.signals.map(() => [])];
    this.plots = CHARTS.map((chart, n) => {
      return new uPlot(optionsOf(chart, { width: 100, height: 60 }, xRange), empty(chart), this.places[n]);
    });
    new ResizeObserver(() => this.resize()).observe(parent);
  }

  resize() {
    const size = (plot, height) => {
      const width = plot.root.parentElement.clientWidth;
      if (width > 0) plot.setSize({ width, height });
    };
    for (const plot of this.plots) size(plot, plot.height);
    // The legend may take another number of lines now; what is left belongs to the plot.
    requestAnimationFrame(() => {
      for (const plot of this.plots) {
        const wrap = plot.root.querySelector(".u-wrap");
        const taken = plot.root.offsetHeight - wrap.offsetHeight;
        size(plot, Math.max(30, plot.root.parentElement.clientHeight - taken - 2));
      }
    });
  }

  /**
   * Show data.
   * @param {number[]} times
   * @param {Record<string, (number|null)[]>} series by column
   */
  show(times, series) {
    this.plots.forEach((plot, n) => {
      plot.setData([times, ...CHARTS[n].signals.map(({ column }) => series[column])]);
    });
  }
}

/** A number that uPlot can draw: a gap where there is none. */
export function drawable(value) {
  return Number.isFinite(value) ? value : null;
}
