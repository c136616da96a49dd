/** The figures at the top of the console. */

import { shownNumber } from "../elements.js";

/** A page that was not heard of for longer is not there [s]. */
const SILENCE = 5;
/** A record that was not written for longer while somebody drives stands still [s]. */
const STILL = 2;
/** Fewer pictures a second than this are too few to drive by. */
const FEW = 30;
/** Slower than this no time of arrival is told [m/s]. */
const CRAWLING = 1;

const KINDS = { ask: "QUESTIONS", consent: "CONSENT", instruct: "READING", break: "BREAK", done: "DONE" };

/** The state in a word, and how it looks. */
export function shownState({ step, stopped }) {
  if (!step) return ["NOBODY", "none"];
  if (stopped) return ["STOPPED", "failed"];
  if (!step.drive) return [KINDS[step.kind] ?? step.kind.toUpperCase(), step.kind];
  const { state } = step.drive;
  if (step.drive.is_broken) return ["FAULT", "failed"];
  return [state.toUpperCase(), state];
}

/** Time as minutes and seconds; a dash where there is none. */
export function clock(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  const whole = Math.max(0, Math.round(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/**
 * What stands beside the state.
 * @param {object} state of the console
 * @param {import("./signals.js").Signals} signals
 * @param {number} duration of the last answer of the server [ms]; NaN if there is none
 * @returns {{name: string, value: string, unit?: string, kind?: string}[]}
 */
export function facts(state, signals, duration) {
  const { step } = state;
  const drive = step?.drive;
  const live = (name, told) => (Number.isFinite(signals.value(name)) ? signals.value(name) : told);
  const seconds = live("time", drive?.seconds);
  const metres = live("longitudinal_position", drive?.metres);
  const way = step?.kind === "drive" && drive?.length ? ` of ${shownNumber(drive.length, 0)} m` : " m";
  return [
    { name: "elapsed", value: clock(seconds) },
    { name: step?.kind === "practise" ? "still to practise" : "remaining",
      value: clock(remaining(step, seconds, metres, signals.value("longitudinal_velocity"))) },
    { name: "driven", value: shownNumber(metres, 0), unit: Number.isFinite(metres) ? way : "" },
    ...criterionFact(step?.criterion),
    recordFact(drive),
    linkFact(state, drive, duration),
    { name: "disk free", value: shownNumber(state.disk.free / 1e9, 1), unit: "GB",
      kind: state.disk.enough ? "" : "bad" },
  ];
}

function remaining(step, seconds, metres, speed) {
  if (step?.kind === "break") return step.remaining;
  if (step?.kind === "practise") return Math.max(0, 60 * step.minutes - (seconds ?? 0));
  if (step?.kind !== "drive" || !(speed > CRAWLING)) return Number.NaN;
  return (step.drive.length - metres) / speed;
}

/** Whether a practice meets its criterion so far; nothing without one. */
function criterionFact(criterion) {
  if (!criterion) return [];
  const { sdlp, below, met } = criterion;
  return [{ name: "SDLP so far", value: shownNumber(sdlp ?? Number.NaN, 2),
    unit: `below ${below} m`, kind: met ? "good" : "bad" }];
}

/** Whether the record is written, and how long ago it was last. */
function recordFact(drive) {
  const name = "record written";
  const age = drive?.written;
  if (age === null || age === undefined) return { name, value: "–" };
  const isStill = drive.state === "running" && age > STILL;
  return { name, value: shownNumber(age, 1), unit: "s ago", kind: isStill ? "bad" : "good" };
}

/** How it stands with the participant's page and the server. */
function linkFact(state, drive, duration) {
  const name = "participant's page";
  if (!Number.isFinite(duration)) return { name, value: "no server", kind: "bad" };
  const isThere = state.page_seen !== null && state.page_seen < SILENCE;
  const needsPage = drive?.state === "running";
  const page = drive?.has_page ? "drives" : isThere ? "open" : "not open";
  const { pictures } = state;
  const isDrawn = page === "drives" && Number.isFinite(pictures);
  const isWell = needsPage ? drive.has_page && !(isDrawn && pictures < FEW) : isThere;
  const unit = `${isDrawn ? `${pictures} fps, ` : ""}${shownNumber(duration, 0)} ms`;
  return { name, value: page, unit, kind: isWell ? "good" : "bad" };
}
