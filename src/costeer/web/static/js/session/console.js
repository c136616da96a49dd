/** The experimenter's console: shows the session, and does what the experimenter decides. */

import { byId, make } from "../elements.js";
import { credentials } from "../options.js";
import { Actions } from "./actions.js";
import { askFirst } from "./dialog.js";
import { facts, shownState } from "./facts.js";
import { Panels } from "./panels.js";
import { ask, Follower } from "./server.js";
import { Signals } from "./signals.js";

/** Time between two questions for the state [ms]. */
const OFTEN = 500;
/** States of a drive in which its socket is open. */
const OPEN = new Set(["ready", "running", "paused"]);

class Console {
  constructor() {
    this.query = credentials(location.search);
    this.state = null;
    this.isLost = false;
    this.duration = Number.NaN;
    this.signals = new Signals(byId("charts"), this.query);
    this.follower = new Follower(() => ask("api/console", this.query), {
      take: (state, duration) => this.take(state, duration),
      lost: () => this.lost(),
      pause: () => OFTEN,
    });
    const act = (action, body) => this.act(action, body);
    this.actions = new Actions(act, () => this.state);
    this.panels = new Panels(act, this.actions);
    this.follower.follow();
    setInterval(() => this.showFacts(), 200);
  }

  /** Do something; the answer is the new state. */
  act(action, body = {}) {
    return this.follower.send(() => ask(`api/console/${action}`, this.query, body));
  }

  lost() {
    this.isLost = true;
    this.showFacts();
    this.showBanners();
  }

  take(state, duration) {
    this.isLost = false;
    if (duration) this.duration = duration;
    this.state = state;
    const { step } = state;
    const drive = step?.drive;
    const attempt = state.attempts.filter((each) => each.step === step?.id).length;
    this.signals.follow(OPEN.has(drive?.state) ? `${state.participant}/${step.id}/${attempt}` : "");
    this.actions.show(state);
    this.panels.show(state);
    this.showFacts();
    this.showBanners();
  }

  /** The line at the top: where the session stands. */
  showFacts() {
    if (!this.state) return this.isLost ? setState("NO LINK", "lost") : undefined;
    const [word, kind] = this.isLost ? ["NO LINK", "lost"] : shownState(this.state);
    setState(word, kind);
    const { participant, step } = this.state;
    const told = step ? `${step.number} of ${step.of}: ${step.id}` : "no participant";
    const who = byId("who");
    if (who.title !== participant + told) {
      who.title = participant + told;
      const place = make("small", {}, step?.kind === "done" ? "all steps are done" : told);
      who.replaceChildren(participant || "–", place);
    }
    const rows = facts(this.state, this.signals, this.isLost ? Number.NaN : this.duration);
    byId("facts").replaceChildren(...rows.map(({ name, value, unit, kind: look }) =>
      make("div", {}, make("dt", {}, name),
        make("dd", { class: look ?? "" }, value, make("small", {}, unit ? ` ${unit}` : "")))));
    return undefined;
  }

  retry() {
    return make("button", { type: "button", onclick: () => this.act("retry").catch(() => {}) },
      "Try again");
  }

  /** Whoever is unwell by a questionnaire goes on by the experimenter's word alone. */
  letGoOn() {
    const { participant, unwell } = this.state;
    return make("button", { type: "button", onclick: () => askFirst({
      title: `Does ${participant} go on?`, text: `${unwell}.`, yes: "Goes on",
      fields: [{ name: "reason", label: "Reason" }],
    }, (given) => this.act("well", given)) }, "Goes on …");
  }

  /** What is wrong with the session as a whole, as long as it is. */
  showBanners() {
    const { trouble, step, disk, stopped, participant, wording, unwell } = this.state ?? {};
    const isUnwell = unwell && `${participant} waits: ${unwell}.`;
    const texts = [
      this.isLost && "The server does not answer. Trying again; a drive pauses by itself.",
      stopped && `${participant}: ${stopped}.`,
      trouble,
      isUnwell,
      wording,
      faultOf(step?.drive),
      ...(step?.drive?.losses ?? []),
      ...(step?.drive?.unkept ?? []),
      disk && !disk.enough && "The disk is nearly full: free some space before the next drive.",
    ].filter(Boolean);
    const key = texts.join("\n");
    if (key === this.banners) return;
    this.banners = key;
    byId("banners").replaceChildren(...texts.map((text) => make("li", {}, text,
      ...(text === trouble ? [this.retry()] : []), ...(text === isUnwell ? [this.letGoOn()] : []))));
  }
}

/** Why the drive stands still, and what lets it go on where that is not its participant's to do. */
function faultOf(drive) {
  if (!drive?.is_broken) return drive?.reason;
  const goOn = drive.state === "paused" ? ", then Go on" : "";
  return `${drive.reason} When that is mended, press Mended${goOn}.`;
}

function setState(word, kind) {
  const place = byId("state");
  if (place.textContent === word) return;
  place.textContent = word;
  place.className = kind;
}

new Console();
