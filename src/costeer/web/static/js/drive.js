/**
 * Drive: a person at the wheel. Socket, controls, view and messages, put together.
 */

import { now } from "./clock.js";
import { Controls, isTyping } from "./controls.js";
import { byId } from "./elements.js";
import { Columns } from "./frames.js";
import { Happenings } from "./happenings.js";
import { Hud, LINK_STATES, refused, toggleFullScreen } from "./hud.js";
import { StateBuffer } from "./interpolation.js";
import { FrameCounter, Latency } from "./latency.js";
import { Panel } from "./panel.js";
import { Link, socketAddress } from "./protocol.js";
import { View } from "./scene/view.js";
import { Sound } from "./sound.js";
import { Strip } from "./strip.js";

/** Longest time between two inputs [s]: they tell the server that the page lives. */
const HEARTBEAT = 0.09;
const [PING_SPACING, SECOND] = [500, 1000];
/** Silence of an open socket after which the page says so [s]; code of one not wanted. */
const [SILENCE, REFUSED] = [2, 1008];
/** Pictures that a page draws unseen: by then everything that they need is built. */
const WARM_PICTURES = 5;
const INDICATOR_KEYS = { KeyZ: 1, Comma: 1, KeyX: -1, Period: -1 };

/** Rows of a table of the server by their number in a frame. */
const byCode = (rows) => new Map(rows.map((row) => [row.code, row]));

export class Drive {
  /**
   * @param {object} hello answer of `api/hello`
   * @param {object} options of the page
   * @param {string} query tokens for the server
   * @param {Record<string, string>} [texts] words of a session for its participant
   */
  constructor(hello, options, query, texts) {
    this.hud = new Hud(texts);
    this.options = options;
    this.happenings = new Happenings(this.hud, new Sound({ isMuted: options.isMuted }));
    this.strip = new Strip(byId("signals"));
    this.controls = new Controls();
    this.latency = new Latency();
    this.pictures = new FrameCounter();
    this.states = new FrameCounter();
    this.counters = options.counters ? byId("counters") : null;
    this.frames = 0;
    this.lastFrame = null;
    this.sentText = "";
    this.sentTime = 0;
    this.heardAt = now();
    this.lastError = "";
    this.isOver = false;
    this.panel = null;
    this.link = null;
    this.query = query;
    this.drawn = 0;
    this.greet(hello);
    if (isSeen()) this.join();
    this.listen();
    requestAnimationFrame((time) => this.draw(time));
  }

  /** Take the seat of the drive that is on now, and leave that of an earlier one. */
  join() {
    this.rest();
    this.isOver = false;
    this.frames = 0;
    this.lastError = "";
    this.heardAt = now();
    this.enter(LINK_STATES.connecting);
    this.link = new Link(socketAddress(location, this.query), {
      hello: (message) => this.greet(message),
      frames: (buffer, received) => this.receive(buffer, received),
      text: (message, received) => this.read(message, received),
      closed: (reason, code) => this.closed(reason, code),
    });
  }

  /** Leave the seat; the scene stays. */
  rest() {
    this.link?.close();
    this.link = null;
  }

  /** Take over a hello: the first, and each one after a lost connection. */
  greet(hello) {
    this.hello = hello;
    this.show(hello);
    this.happenings.greet(hello);
    this.columns = new Columns(hello.columns, hello.stepped);
    this.runStates = byCode(hello.run_states);
    this.faults = byCode(hello.faults);
    this.buffer = new StateBuffer(this.columns, hello.rate ?? 60);
    // A force-feedback wheel is a gamepad for the browser too; the server reads it better.
    this.controls.mayUseGamepad = hello.input !== "wheel";
    this.latency.ofWheel = hello.input === "wheel";
    this.maySeeSignals = hello.role === "experimenter" || hello.show_signals !== false;
    this.strip.isShown = this.maySeeSignals && !this.isStripClosed;
    this.hud.describeKeys("drive", hello.role);
    if (this.link && hello.role === "experimenter") this.panel = new Panel(hello, this.link);
    this.hud.losses(hello.losses ?? []);
    this.lastFrame = null;
    this.stands = [hello.run_state ?? 0, hello.fault ?? 0];
    if (this.link) this.enterTrial();
  }

  /** Draw the road of a hello; the next drive of a session may be on another one. */
  show(hello) {
    const road = JSON.stringify([hello.road, hello.scenario, hello.other_cars]);
    if (road === this.road) return;
    this.road = road;
    this.view?.close();
    this.view = new View(byId("view"), hello, this.options);
  }

  /** Show where the trial stands, as the server told it last. */
  enterTrial() {
    if (this.isOver) return;
    const [state, fault] = this.stands;
    const shown = this.happenings.state(this.runStates.get(state), this.lastValue("contact"));
    this.enter(shown, this.faults.get(fault));
  }

  /** The socket has closed: the server has ended, let this page go, or is lost. */
  closed(reason, code) {
    const why = reason || this.lastError;
    if (this.isOver) this.enter(LINK_STATES.over);
    else if (code === REFUSED && why) this.enter(refused(why));
    else this.enter(LINK_STATES.lost);
  }

  listen() {
    addEventListener("keydown", (event) => this.keyDown(event));
    addEventListener("keyup", (event) => this.controls.key(event.code, false) && this.sendInput());
    byId("banner").addEventListener("click", () => this.goOn()); // without a keyboard
    document.addEventListener("visibilitychange", () => {
      const drives = this.hello.role === "driver" && this.state === "running";
      if (document.hidden && drives) this.link?.send({ type: "pause" });
    });
    setInterval(() => this.sendInput(), 20);
    setInterval(() => this.link?.send({ type: "ping", t: now() * 1000 }), PING_SPACING);
    setInterval(() => this.everySecond(), SECOND);
  }

  keyDown(event) {
    if (isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.controls.key(event.code, true)) {
      this.sendInput();
      event.preventDefault();
    } else if (!event.repeat && this.command(event.code, event.key)) event.preventDefault();
  }

  /** Do what a key commands; tell whether it is a command. */
  command(code, key) {
    if (code in INDICATOR_KEYS) this.indicate(INDICATOR_KEYS[code]);
    else if (code === "Enter" || code === "NumpadEnter" || code === "Space") this.goOn();
    else if (code === "KeyP") this.state === "paused" ? this.goOn() : this.link?.send({ type: "pause" });
    else if (code === "KeyC") this.mayAcknowledge && this.link?.send({ type: "acknowledge" });
    else if (code === "KeyH" || key === "?") this.hud.toggleHelp();
    else if (code === "KeyF") toggleFullScreen();
    else if (code === "KeyS") this.toggleStrip();
    else if (code === "KeyE") this.panel?.toggle();
    else return this.happenings.command(code, key);
    return true;
  }

  goOn() {
    if (this.goesOnBy) this.link?.send({ type: this.goesOnBy });
  }

  lastValue(name) {
    return this.lastFrame ? this.columns.finite(this.lastFrame, name) : 0;
  }

  /** The same side again switches the indicator off. */
  indicate(side) {
    this.link?.send({ type: "indicator", side: this.lastValue("indicator") === side ? 0 : side });
  }

  toggleStrip() {
    if (!this.maySeeSignals) return;
    this.strip.isShown = !this.strip.isShown;
    this.isStripClosed = !this.strip.isShown;
  }

  /** Send hands and feet if they moved or if the server has to hear from the page. */
  sendInput() {
    const controls = this.controls.read();
    const text = JSON.stringify(controls);
    const time = now();
    if (text === this.sentText && time - this.sentTime < HEARTBEAT) return;
    [this.sentText, this.sentTime] = [text, time];
    if (this.link?.connected) this.latency.inputSent(this.link.sendInput(controls));
  }

  receive(buffer, received) {
    this.heardAt = now();
    for (const frame of this.columns.split(buffer)) {
      this.buffer.push(frame, received);
      this.strip.push(this.columns, frame);
      this.latency.frameReceived(this.columns, frame, received);
      this.states.tick(received);
      this.frames += 1;
      this.lastFrame = frame;
    }
    if (!this.lastFrame) return;
    this.stands = [this.lastValue("run_state"), this.lastValue("fault")];
    this.enterTrial();
  }

  /** Read a text message. */
  read(message, received) {
    this.heardAt = now();
    if (this.state === LINK_STATES.silent.name) this.enterTrial();
    if (message.type === "losses") this.hud.losses(message.texts);
    else if (message.type === "farewell") this.end();
    else if (message.type === "pong") this.latency.pong(message, received);
    else if (message.type === "state") this.panel?.state(message);
    else if (message.type === "error") this.fail(message.text);
    else if (message.type === "marker" && this.hello.role === "experimenter") {
      this.hud.note(message.text);
    }
  }

  fail(text) {
    this.lastError = text;
    this.hud.note(text, 6);
  }

  /** The server ends: nothing is tried again. */
  end() {
    this.isOver = true;
    if (this.link) this.link.isOver = true;
    this.enter(LINK_STATES.over);
  }

  /** Take on a state: of the trial, from the server's table, or of the link. */
  enter(state, fault) {
    this.state = state.name;
    const mustWait = fault?.text && (!fault.can_resume || fault.must_be_acknowledged);
    this.goesOnBy = mustWait ? "" : state.goes_on_by;
    this.mayAcknowledge = Boolean(fault?.must_be_acknowledged);
    this.hud.state(state, fault);
  }

  everySecond() {
    if (this.link?.connected && now() - this.heardAt > SILENCE) this.enter(LINK_STATES.silent);
    this.link?.sendLatencies(this.latency.takeUnsent());
    const figures = this.figures();
    this.panel?.show(figures);
    if (!this.counters) return;
    const { input } = figures.latency;
    const delay = Number.isFinite(input.p50) ? `, ${input.p50.toFixed(0)} ms` : "";
    this.counters.textContent = `${figures.fps.toFixed(0)} fps${delay}`;
  }

  figures() {
    const told = this.lastFrame ? this.columns.named(this.lastFrame) : {};
    const { lateness = Number.NaN, compute_time: computeTime = Number.NaN } = told;
    const latency = this.latency.summary();
    return { fps: this.pictures.fps, frameRate: this.states.fps, latency, lateness, computeTime };
  }

  draw(time) {
    requestAnimationFrame((next) => this.draw(next));
    if (!isSeen() && this.drawn >= WARM_PICTURES) return;
    this.drawn += 1;
    this.pictures.tick(time / 1000);
    const state = this.buffer.at(now());
    if (state) {
      this.view.update(this.columns, state);
      const [isRunning, warns] = [this.state === "running", this.stands[1] !== 0];
      this.happenings.see((name) => this.columns.finite(state, name), { isRunning, warns });
    }
    this.view.render();
    this.strip.paint(time / 1000);
  }

  /** What tests and curious people may read as `window.costeer`. */
  get report() {
    const { lastFrame } = this;
    return {
      mode: "drive",
      fps: this.pictures.fps,
      frameRate: this.states.fps,
      latency: this.latency.summary(),
      frames: this.frames,
      lastFrame: lastFrame && this.columns.named(lastFrame),
      state: this.state,
      join: () => this.join(),
      rest: () => this.rest(),
    };
  }
}

/** Whether this page is seen; one that is prepared in a frame for later is inert. */
const isSeen = () => !globalThis.frameElement?.inert;
