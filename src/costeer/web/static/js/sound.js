/**
 * Sound: engine, tyres, wind, indicator, rumble strip and warnings, made by Web Audio.
 *
 * Speed without sound is misjudged. Nothing is loaded: oscillators and noise. Browsers let a
 * page sound only after a key or a click, so the graph is made at the first one.
 */

import { isLit } from "./scene/dashboard.js";

/** Grooves of the rumble strip lie so far apart [m] (plant/place.py). */
const STRIP_PERIOD = 0.6;

/** How quickly a sound takes on a new value [s]. */
const GLIDE = 0.06;

/** Speed at which each gear begins [m/s], and turns of the engine per metre in it [1/m]. */
const GEARS = [[0, 5.6], [5, 3.2], [10, 2.1], [15, 1.6], [20, 1.3]];
const IDLE = 13;

const STRIP = 1;
const BARRIER = 2;
const STEPS = 0.1;
const KEPT_UNDER = "costeer-sound";

/** Turns of the engine per second at a speed [m/s]. */
export function engineRate(speed) {
  const [, ratio] = GEARS.findLast(([from]) => speed >= from) ?? GEARS[0];
  return Math.max(IDLE, speed * ratio);
}

/**
 * Levels in [0, 1] of what sounds all the time.
 * @param {{speed: number, accelerator: number, contact: number, isRunning: boolean}} state
 */
export function levels({ speed, accelerator, contact, isRunning }) {
  const share = isRunning ? Math.min(Math.max(speed, 0) / 33, 1.3) : 0;
  return {
    engine: isRunning ? 0.1 + 0.12 * share + 0.12 * accelerator : 0,
    tyres: 0.3 * share ** 1.5,
    wind: 0.34 * share ** 2.5,
    rumble: isRunning && contact === STRIP ? 0.5 * Math.min(1, speed / 8) : 0,
  };
}

/** Two seconds of noise that repeat. */
function noiseBuffer(context) {
  const buffer = context.createBuffer(1, 2 * context.sampleRate, context.sampleRate);
  const values = buffer.getChannelData(0);
  for (let n = 0; n < values.length; n++) values[n] = 2 * Math.random() - 1;
  return buffer;
}

/** The nodes that sound all the time. */
class Graph {
  constructor(context) {
    this.context = context;
    this.master = context.createGain();
    this.master.gain.value = 0;
    this.master.connect(context.destination);
    this.noise = noiseBuffer(context);
    this.gains = {};
    this.engine = [this.tone("engine", "sawtooth", 320), this.tone("engine", "triangle", 260)];
    this.strip = this.tone("rumble", "square", 420);
    this.hiss("tyres", "bandpass", 620);
    this.hiss("wind", "lowpass", 480);
  }

  /** A gain by name, one for all that is called so. */
  level(name) {
    if (!this.gains[name]) {
      this.gains[name] = this.context.createGain();
      this.gains[name].gain.value = 0;
      this.gains[name].connect(this.master);
    }
    return this.gains[name];
  }

  filtered(source, name, type, frequency) {
    const filter = this.context.createBiquadFilter();
    filter.type = type;
    filter.frequency.value = frequency;
    source.connect(filter);
    filter.connect(this.level(name));
    source.start();
  }

  tone(name, type, cutoff) {
    const source = this.context.createOscillator();
    source.type = type;
    this.filtered(source, name, "lowpass", cutoff);
    return source;
  }

  hiss(name, type, frequency) {
    const source = this.context.createBufferSource();
    source.buffer = this.noise;
    source.loop = true;
    this.filtered(source, name, type, frequency);
  }

  glide(parameter, value) {
    parameter.setTargetAtTime(value, this.context.currentTime, GLIDE);
  }

  /** A short tone that dies away. */
  beep(frequency, level, duration, delay = 0) {
    const [source, gain] = [this.context.createOscillator(), this.context.createGain()];
    const start = this.context.currentTime + delay;
    source.frequency.value = frequency;
    gain.gain.setValueAtTime(level, start);
    gain.gain.exponentialRampToValueAtTime(0.001, start + duration);
    source.connect(gain);
    gain.connect(this.master);
    source.start(start);
    source.stop(start + duration);
  }
}

/** Whether the browser knows of its audio devices and has none. */
async function lacksDevice() {
  if (typeof AudioContext === "undefined") return true;
  // Others than those that can choose a device do not tell which there are.
  if (!("setSinkId" in AudioContext.prototype) || !navigator.mediaDevices) return false;
  const devices = await navigator.mediaDevices.enumerateDevices();
  return !devices.some(({ kind }) => kind === "audiooutput");
}

/** What was chosen last time; a browser may keep nothing. */
function remembered() {
  try {
    return JSON.parse(localStorage.getItem(KEPT_UNDER)) ?? {};
  } catch {
    return {};
  }
}

function remember(chosen) {
  try {
    localStorage.setItem(KEPT_UNDER, JSON.stringify(chosen));
  } catch {
    // It holds for this page alone.
  }
}

export class Sound {
  /**
   * @param {{isMuted?: boolean, make?: () => AudioContext, lacks?: () => Promise<boolean>}} options
   */
  constructor({ isMuted = false, make = () => new AudioContext(), lacks = lacksDevice } = {}) {
    const kept = remembered();
    this.volume = Number.isFinite(kept.volume) ? kept.volume : 0.6;
    this.isMuted = isMuted || kept.isMuted === true;
    this.make = make;
    this.lacks = lacks;
    this.graph = null;
    this.isWaking = false;
    this.before = { lit: false, contact: 0, warns: false };
  }

  /** Begin to sound; call it from a handler of a key or a click. */
  async wake() {
    if (this.graph || this.isWaking) return;
    this.isWaking = true;
    if (await this.lacks().catch(() => false)) return; // for good: there is nothing to hear
    try {
      this.graph = new Graph(this.make());
      await this.graph.context.resume();
      this.apply();
    } catch (error) {
      console.warn(`no sound: ${error.message}`);
      this.graph = null;
    }
  }

  apply() {
    if (this.graph) this.graph.glide(this.graph.master.gain, this.isMuted ? 0 : this.volume);
    remember({ volume: this.volume, isMuted: this.isMuted });
    return this.told;
  }

  get told() {
    return this.isMuted ? "Sound off" : `Sound ${Math.round(100 * this.volume)} %`;
  }

  /** Off or on; returns what to tell. */
  toggle() {
    this.isMuted = !this.isMuted;
    return this.apply();
  }

  /** Louder (+1) or softer (-1); returns what to tell. */
  change(direction) {
    this.volume = Math.min(1, Math.max(0, Math.round(10 * (this.volume + STEPS * direction)) / 10));
    this.isMuted = false;
    return this.apply();
  }

  /**
   * Sound like a state.
   * @param {{speed: number, accelerator: number, contact: number, indicator: number,
   *   isRunning: boolean, warns: boolean, time: number}} state `time` for the ticking [s]
   */
  update(state) {
    const { graph } = this;
    if (!graph) return;
    const rate = engineRate(state.speed);
    graph.glide(graph.engine[0].frequency, 2 * rate);
    graph.glide(graph.engine[1].frequency, rate);
    graph.glide(graph.strip.frequency, Math.max(state.speed, 1) / STRIP_PERIOD);
    for (const [name, level] of Object.entries(levels(state))) {
      graph.glide(graph.level(name).gain, level);
    }
    this.happen(state);
  }

  /** What sounds once: ticks, a hit, a warning. */
  happen({ indicator, contact, isRunning, warns, time }) {
    const { graph, before } = this;
    const lit = isRunning && indicator !== 0 && isLit(time);
    if (lit !== before.lit) graph.beep(lit ? 1500 : 1100, 0.16, 0.03);
    if (contact >= BARRIER && before.contact < BARRIER) {
      graph.beep(58, 0.9, 0.6);
      graph.beep(37, 0.9, 0.8);
    }
    if (warns && !before.warns) for (const delay of [0, 0.25]) graph.beep(880, 0.3, 0.18, delay);
    this.before = { lit, contact, warns };
  }
}
