/**
 * Replay: a recorded trial in the view that its driver had.
 */

import { Charts, DRAWN, drawable } from "./charts.js";
import { isTyping } from "./controls.js";
import { byId } from "./elements.js";
import { Columns } from "./frames.js";
import { Happenings } from "./happenings.js";
import { Hud, toggleFullScreen } from "./hud.js";
import { FrameCounter } from "./latency.js";
import { Playback } from "./playback.js";
import { View } from "./scene/view.js";
import { Sound } from "./sound.js";
import { Transport } from "./transport.js";

export class Replay {
  /**
   * @param {object} hello answer of `api/hello`
   * @param {ArrayBuffer} record answer of `api/record`
   * @param {object} options of the page
   */
  constructor(hello, record, options) {
    this.columns = new Columns(hello.columns, hello.stepped);
    this.playback = new Playback(this.columns, this.columns.split(record));
    this.hud = new Hud();
    this.hud.describeKeys("replay", hello.role);
    this.happenings = new Happenings(this.hud, new Sound({ isMuted: options.isMuted }));
    this.happenings.greet(hello);
    this.view = new View(byId("view"), hello, options);
    this.transport = new Transport(byId("transport"), this.playback, hello);
    this.counters = options.counters ? byId("counters") : null;
    this.pictures = new FrameCounter();
    this.last = null;
    if (hello.title) document.title = `${hello.title} – costeer replay`;
    byId("signals").hidden = false;
    byId("signals").classList.add("whole");
    this.charts = this.drawSignals();
    addEventListener("keydown", (event) => this.keyDown(event));
    requestAnimationFrame((time) => this.draw(time));
  }

  /** Charts over the whole trial: a click seeks, a line shows the time. */
  drawSignals() {
    const { start, end, rows, times } = this.playback;
    const charts = new Charts(byId("signals"), () => [start, Math.max(end, start + 1)]);
    const series = DRAWN.map((name) => [
      name, rows.map((row) => drawable(this.columns.value(row, name))),
    ]);
    charts.show(times, Object.fromEntries(series));
    this.cursors = charts.plots.map((plot) => {
      plot.over.addEventListener("click", (event) => {
        this.playback.seek(plot.posToVal(event.offsetX, "x"));
      });
      const line = document.createElement("div");
      line.style.cssText =
        "position:absolute;top:0;bottom:0;width:1px;background:#ff5a3c;pointer-events:none";
      plot.over.append(line);
      return { plot, line };
    });
    return charts;
  }

  keyDown(event) {
    if (isTyping(event.target) && event.target.type !== "range") return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.command(event)) event.preventDefault();
  }

  command({ code, key, shiftKey }) {
    const { playback } = this;
    const rows = shiftKey ? 60 : 1;
    if (code === "Space") playback.toggle();
    else if (code === "ArrowLeft") playback.step(-rows);
    else if (code === "ArrowRight") playback.step(rows);
    else if (code === "ArrowUp") playback.changeSpeed(1);
    else if (code === "ArrowDown") playback.changeSpeed(-1);
    else if (code === "Home") playback.seek(playback.start);
    else if (code === "End") playback.seek(playback.end);
    else if (code === "KeyS") byId("signals").hidden = !byId("signals").hidden;
    else if (code === "KeyF") toggleFullScreen();
    else if (code === "KeyH" || key === "?") this.hud.toggleHelp();
    else return this.happenings.command(code, key);
    return true;
  }

  draw(time) {
    requestAnimationFrame((next) => this.draw(next));
    this.pictures.tick(time / 1000);
    this.playback.advance(this.last === null ? 0 : (time - this.last) / 1000);
    this.last = time;
    this.shown = this.playback.state();
    this.view.update(this.columns, this.shown);
    this.happenings.see((name) => this.columns.finite(this.shown, name), {
      isRunning: this.playback.isPlaying, warns: false,
    });
    this.view.render();
    this.transport.show();
    for (const { plot, line } of this.cursors) {
      line.style.left = `${plot.valToPos(this.playback.time, "x").toFixed(1)}px`;
    }
    if (this.counters) this.counters.textContent = `${this.pictures.fps.toFixed(0)} fps`;
  }

  /** What tests and curious people may read as `window.costeer`. */
  get report() {
    return {
      mode: "replay",
      fps: this.pictures.fps,
      frames: this.playback.rows.length,
      lastFrame: this.shown ? this.columns.named(this.shown) : null,
      state: this.playback.isPlaying ? "playing" : "stopped",
      time: this.playback.time,
      speed: this.playback.speed,
    };
  }
}
