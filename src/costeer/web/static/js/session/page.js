/**
 * The participant's page: shows the step that is on, whatever happened before.
 *
 * The server alone knows what comes next; a reload, a second click or a second tab only
 * show its state again.
 */

import { byId } from "../elements.js";
import { DriveFrame } from "./drive_frame.js";
import { ask, Follower } from "./server.js";
import { Stopping } from "./stopping.js";
import { viewOf } from "./views.js";
import { words } from "./words.js";

/** Time between two questions for the state [ms]: where it may change, and elsewhere. */
const OFTEN = 500;
const SELDOM = 2000;
const CHANGING = new Set(["practise", "drive", "break"]);
/** What has no use for the button to stop. */
const NO_WAY_OUT = new Set(["idle", "consent", "done", "frame", "stopped", "left"]);
const OVER = new Set(["saving", "ended", "failed"]);

class Page {
  constructor() {
    const given = new URLSearchParams(location.search);
    given.delete("experimenter"); // whoever looks on here is a participant
    this.frame = new DriveFrame(given);
    const token = given.get("token");
    this.query = token ? `?${new URLSearchParams({ token })}` : "";
    this.state = null;
    this.shown = "";
    this.view = null;
    this.readyFor = "";
    this.isLost = false;
    this.stopping = new Stopping((deletes) => this.stop(deletes));
    this.follower = new Follower(() => ask("api/session", this.told()), {
      take: (state) => this.take(state),
      lost: () => this.lost(),
      pause: () => this.pause(),
    });
    this.follower.follow();
  }

  pause() {
    const step = this.state?.step;
    return !step || this.isLost || CHANGING.has(step.kind) ? OFTEN : SELDOM;
  }

  /** Token, and how well the drive is drawn, which the console shows. */
  told() {
    const { pictures } = this.frame;
    if (pictures === undefined) return this.query;
    return `${this.query}${this.query ? "&" : "?"}pictures=${pictures.toFixed(0)}`;
  }

  lost() {
    this.isLost = true;
    this.showBanner();
  }

  /** Send what the participant did; the answer is the new state. */
  send(path, body) {
    return this.follower.send(() => ask(path, this.query, body));
  }

  take(state) {
    this.isLost = false;
    const before = this.state;
    const isThanked = (before?.step?.kind === "done" || before?.stopped) && !state.step;
    this.state = isThanked ? { ...before, trouble: state.trouble, isLeft: true } : state;
    this.show();
  }

  /** Show the state; what is on show already is only brought up to date. */
  show() {
    const { state } = this;
    const face = this.face();
    const key = JSON.stringify([state.participant, state.language, state.step?.id, face]);
    if (key !== this.shown) {
      this.shown = key;
      this.enter(face);
    }
    this.view?.update?.(state);
    const isNear = face === "brief" && state.step.drive.state === "ready" && !document.hidden;
    this.frame.update(state, isNear, face === "frame");
    this.stopping.show(state, NO_WAY_OUT.has(face));
    this.showHead();
    this.showBanner();
  }

  /** What of a step is shown: a drive has several faces. */
  face() {
    const { step, participant, stopped, isLeft } = this.state;
    if (!step) return "idle";
    if (stopped) return isLeft ? "left" : "stopped";
    if (step.kind !== "practise" && step.kind !== "drive") return step.kind;
    const { state } = step.drive;
    const me = `${participant}/${step.id}/${step.attempt}`;
    if (OVER.has(state)) {
      this.readyFor = "";
      return "saving";
    }
    if (state === "running" || state === "paused") return "frame";
    if (this.state.held) return "wait";
    if (this.readyFor !== me) return "brief";
    return state === "ready" ? "frame" : "wait";
  }

  enter(face) {
    const { state } = this;
    const root = byId("step");
    document.documentElement.lang = state.language;
    byId("said").textContent = "";
    root.setAttribute("aria-busy", "false");
    this.view = viewOf(face, root, state, {
      next: () => this.send("api/session/next", this.own({ step: state.step.id })),
      answer: (answers) => this.answer(state.step.id, answers),
      ready: () => this.ready(),
      stop: (deletes) => this.stop(deletes).catch(() => {}),
      resume: () => this.send("api/session/resume", this.own({})),
      say: (text) => {
        byId("said").textContent = text;
      },
    });
    scrollTo(0, 0);
  }

  /** What is sent, with whose it is: another may sit here before it arrives. */
  own(body) {
    return { participant: this.state.participant, ...body };
  }

  /** Take no part any more; the experimenter is told at once. */
  stop(deletes) {
    return this.send("api/session/stop", this.own({ delete: deletes }));
  }

  /** Send answers; those of a step that is over are answered by the step that is on. */
  async answer(step, answers) {
    try {
      await this.send("api/session/answers", this.own({ step, answers }));
    } catch (error) {
      if (error.answer?.state) return;
      if (error.answer) throw error;
      throw new Error(words(this.state.texts, "error_connection"));
    }
  }

  ready() {
    const { participant, step } = this.state;
    this.readyFor = `${participant}/${step.id}/${step.attempt}`;
    this.show();
  }

  showHead() {
    const { step, texts, title } = this.state;
    const heading = document.querySelector("#step h1")?.textContent;
    byId("title").textContent = title;
    document.title = heading ? `${heading} – ${title}` : title;
    const isCounted = step && step.kind !== "done";
    byId("progress").textContent = isCounted
      ? words(texts, "scale_place", { number: step.number, count: step.of }) : "";
  }

  /** What is wrong, as long as it is; the gravest alone. */
  showBanner() {
    const texts = this.state?.texts ?? {};
    const lost = texts.error_connection ?? "Connection lost, trying again …";
    let text = this.isLost ? lost : "";
    if (!text && this.state?.trouble) text = `${words(texts, "error_title")}: ${this.state.trouble}`;
    if (!text && this.frame.isRefused) text = words(texts, "error_elsewhere");
    const banner = byId("banner");
    banner.hidden = !text;
    if (banner.textContent !== text) banner.textContent = text;
  }
}

new Page();
