/**
 * Dashboard: the instruments, painted on a canvas: speed, distance and indicators.
 */

import { PlaneGeometry } from "../../vendor/three.module.js";
import { canvas, textureOf } from "./textures.js";

const TOP_SPEED = 160;
const START = Math.PI * 0.8;
const SWEEP = Math.PI * 1.4;

/** Times per second that an indicator lights up. */
const BLINKS = 1.5;

/** Whether somebody wishes for less that moves and blinks. */
export const isCalm = globalThis.matchMedia?.("(prefers-reduced-motion: reduce)").matches ?? false;

/** Whether an indicator that is on is lit at a time [s]; where less shall move, always. */
export function isLit(time) {
  return isCalm || (time * BLINKS) % 1 < 0.55;
}

/** Size of the picture, drawn in these units whatever its resolution. */
const WIDTH = 900;
const HEIGHT = 300;

function angleOf(speedKmh) {
  return START + SWEEP * Math.min(Math.max(speedKmh / TOP_SPEED, 0), 1.02);
}

function onCircle(angle, radius) {
  return [450 + radius * Math.cos(angle), 172 + radius * Math.sin(angle)];
}

export class Dashboard {
  constructor(low) {
    const scale = low ? 0.8 : 1.6;
    this.face = canvas(WIDTH * scale, HEIGHT * scale);
    this.face.pen.scale(scale, scale);
    this.dial = canvas(WIDTH * scale, HEIGHT * scale);
    this.dial.pen.scale(scale, scale);
    this.paintDial(this.dial.pen);
    this.texture = textureOf(this.face.element, { sharpness: 4 });
    this.shown = "";
    this.update({ speed: 0, distance: 0, indicator: 0, time: 0 });
  }

  /** The plane that bears the instruments, `width` metres wide. */
  mesh(workshop, width) {
    const geometry = new PlaneGeometry(width, (width * HEIGHT) / WIDTH);
    return workshop.plain(geometry, { map: this.texture });
  }

  paintDial(pen) {
    pen.fillStyle = "#0b0e11";
    pen.fillRect(0, 0, WIDTH, HEIGHT);
    pen.strokeStyle = "#3a434b";
    pen.lineWidth = 3;
    pen.beginPath();
    pen.arc(450, 172, 152, START, START + SWEEP);
    pen.stroke();
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (let speed = 0; speed <= TOP_SPEED; speed += 10) this.paintTick(pen, speed);
  }

  paintTick(pen, speed) {
    const isLong = speed % 20 === 0;
    pen.strokeStyle = "#e8edf0";
    pen.lineWidth = isLong ? 5 : 3;
    pen.beginPath();
    pen.moveTo(...onCircle(angleOf(speed), isLong ? 130 : 138));
    pen.lineTo(...onCircle(angleOf(speed), 150));
    pen.stroke();
    if (!isLong) return;
    pen.fillStyle = "#e8edf0";
    pen.font = "600 22px system-ui, sans-serif";
    pen.fillText(String(speed), ...onCircle(angleOf(speed), 107));
  }

  /**
   * Paint what has changed.
   * @param {{speed: number, distance: number, indicator: number, time: number}} state
   *   speed [m/s], distance driven [m], indicator +1 left, time for the blinking [s]
   */
  update({ speed, distance, indicator, time }) {
    const kmh = Math.abs(speed) * 3.6;
    const lit = indicator !== 0 && isLit(time) ? indicator : 0;
    const wanted = `${kmh.toFixed(1)} ${(distance / 100).toFixed(0)} ${lit}`;
    if (wanted === this.shown) return;
    this.shown = wanted;
    const { pen } = this.face;
    pen.drawImage(this.dial.element, 0, 0, WIDTH, HEIGHT);
    this.paintNeedle(pen, kmh);
    this.paintFigures(pen, kmh, distance);
    this.paintArrow(pen, 150, 1, lit > 0);
    this.paintArrow(pen, 750, -1, lit < 0);
    this.texture.needsUpdate = true;
  }

  paintNeedle(pen, kmh) {
    pen.strokeStyle = "#ff5a3c";
    pen.lineWidth = 6;
    pen.beginPath();
    pen.moveTo(...onCircle(angleOf(kmh), 70));
    pen.lineTo(...onCircle(angleOf(kmh), 146));
    pen.stroke();
  }

  paintFigures(pen, kmh, distance) {
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillStyle = "#ffffff";
    pen.font = "600 78px system-ui, sans-serif";
    pen.fillText(kmh.toFixed(0), 450, 172);
    pen.fillStyle = "#93a1ac";
    pen.font = "500 22px system-ui, sans-serif";
    pen.fillText("km/h", 450, 224);
    pen.fillText(`${(Math.max(0, distance) / 1000).toFixed(1)} km`, 450, 262);
  }

  /** An arrow that points to the left for side +1. */
  paintArrow(pen, x, side, isLit) {
    pen.fillStyle = isLit ? "#35e07a" : "#1d252b";
    pen.beginPath();
    const points = [[-62, 0], [-6, -50], [-6, -24], [52, -24], [52, 24], [-6, 24], [-6, 50]];
    points.forEach(([dx, dy], n) => {
      const place = [x + side * dx, 96 + dy];
      if (n === 0) pen.moveTo(...place);
      else pen.lineTo(...place);
    });
    pen.fill();
  }
}
