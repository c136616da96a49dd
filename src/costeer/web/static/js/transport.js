/**
 * Transport: the bar of a replay, with play, speed, time and markers.
 */

import { make } from "./elements.js";
import { SPEEDS } from "./playback.js";

/** Time as minutes and seconds. */
function clockTime(seconds) {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}

export class Transport {
  /**
   * @param {HTMLElement} parent
   * @param {import("./playback.js").Playback} playback
   * @param {{title?: string, markers?: {time: number, text: string}[]}} hello
   */
  constructor(parent, playback, hello) {
    this.playback = playback;
    this.button = make("button", { type: "button", "aria-label": "Play or stop", onclick: (event) => {
      playback.toggle();
      event.currentTarget.blur();
    } });
    this.scrubber = make("input", {
      type: "range", min: playback.start, max: playback.end, step: "any", "aria-label": "Time",
      oninput: () => playback.seek(Number(this.scrubber.value)),
      onchange: () => this.scrubber.blur(),
    });
    this.time = make("output");
    this.speed = make("select", { "aria-label": "Speed", onchange: () => {
      playback.speed = Number(this.speed.value);
      this.speed.blur();
    } });
    this.speed.append(...SPEEDS.map((speed) => make("option", { value: speed }, `${speed}×`)));
    const marks = make("div", { class: "marks" }, ...this.marks(hello.markers ?? []));
    const track = make("div", { class: "track" }, this.scrubber, marks);
    const title = make("span", { class: "title", title: hello.title ?? "" }, hello.title ?? "");
    parent.replaceChildren(this.button, this.speed, track, this.time, title);
    parent.hidden = false;
  }

  marks(markers) {
    const { start, end } = this.playback;
    return markers.map(({ time, text }) => {
      const mark = make("span", {
        title: `${clockTime(time)} ${text}`,
        onclick: () => this.playback.seek(time),
      });
      mark.style.left = `${(100 * (time - start)) / Math.max(end - start, 1e-9)}%`;
      return mark;
    });
  }

  /** Show where the replay is. */
  show() {
    const { time, end, isPlaying, speed } = this.playback;
    this.button.textContent = isPlaying ? "❚❚" : "▶";
    if (document.activeElement !== this.scrubber) this.scrubber.value = String(time);
    if (document.activeElement !== this.speed) this.speed.value = String(speed);
    this.time.value = `${clockTime(time)} / ${clockTime(end)}`;
  }
}
