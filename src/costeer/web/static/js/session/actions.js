/** The large buttons of the console, and the notes. */

import { byId, make } from "../elements.js";
import { askFirst, errorBox } from "./dialog.js";

/** Within this time a second Escape stops the drive [ms]. */
const TWICE = 1000;

const isIn = (...states) => ({ step }) => states.includes(step?.drive?.state);
const isOn = isIn("starting", "ready", "running", "paused");
/** A fault stopped the drive: nobody goes on before the experimenter says that it is mended. */
const isBroken = ({ step }) => Boolean(step?.drive?.is_broken);
const hasStep = ({ step }) => Boolean(step);

/** Buttons from left to right, and when each makes sense. */
const BUTTONS = [
  { action: "start", label: "Start", when: (state) => isIn("ready")(state) && !isBroken(state) },
  { action: "pause", label: "Pause", when: isIn("running") },
  { action: "acknowledge", label: "Mended", when: isBroken },
  { action: "resume", label: "Go on", when: (state) => isIn("paused")(state) && !isBroken(state) },
  { action: "stop", label: "Stop", when: isOn, question: {
    title: "Stop this drive?", text: "It is kept as aborted, and the step is driven again.", yes: "Stop the drive",
  } },
  { action: "finish", label: "Finish practice", when: (state) => state.step?.kind === "practise" && isOn(state) },
  { action: "repeat", label: "Repeat …", when: ({ steps }) => steps.some((step) => step.state) },
  { action: "skip", label: "Skip …", when: (state) => hasStep(state) && state.step.kind !== "done" },
];

export class Actions {
  /**
   * @param {(action: string, body?: object) => Promise<object>} act
   * @param {() => object} newest gives the newest state of the console
   */
  constructor(act, newest) {
    this.act = act;
    this.newest = newest;
    this.escaped = Number.NEGATIVE_INFINITY;
    this.places = BUTTONS.map((button) => this.place(button));
    const stop = make("button", { type: "button", id: "emergency",
      title: "Stops the drive at once; also Escape twice", onclick: () => this.emergency() },
    "EMERGENCY STOP");
    this.emergencyPlace = make("div", { class: "place last" }, stop);
    byId("actions").append(...this.places.map(({ place }) => place), this.emergencyPlace);
    addEventListener("keydown", (event) => this.keyDown(event), { capture: true });
    this.makeNote();
  }

  place(button) {
    const element = make("button", { type: "button", id: button.action, disabled: true,
      onclick: () => this.press(button, place) }, button.label);
    const place = make("div", { class: "place" }, element);
    return { ...button, element, place };
  }

  /** Do something; what the server says against it is shown beside the button. */
  async tryTo(place, action, body) {
    place.querySelector(":scope > .error")?.remove();
    try {
      await this.act(action, body);
      byId("said").textContent = `${action}: done`;
      return true;
    } catch (error) {
      place.append(errorBox(error.message));
      return false;
    }
  }

  press({ action, question }, place) {
    if (question) askFirst(question, () => this.act(action));
    else if (action === "repeat") this.askRepeat();
    else if (action === "skip") this.askSkip();
    else this.tryTo(place, action);
  }

  askRepeat() {
    const over = this.newest().steps.filter((step) => step.state).map((step) => step.id);
    const drives = over.filter((id) => /^(drive|practise)/.test(id));
    askFirst({
      title: "Repeat a step", yes: "Repeat it",
      text: "A drive that was whole is excluded with this reason and kept; answers of the step are asked again.",
      fields: [
        { name: "step", label: "Step", options: over.toReversed(), value: drives.at(-1) ?? over.at(-1) },
        { name: "reason", label: "Reason" },
      ],
    }, (given) => this.act("repeat", given));
  }

  askSkip() {
    const { step } = this.newest();
    askFirst({
      title: `Skip ${step.id}?`, text: "The step is left out of this participant's session.",
      yes: "Skip it", fields: [{ name: "reason", label: "Reason" }],
    }, ({ reason }) => this.act("skip", { step: step.id, reason }));
  }

  keyDown(event) {
    if (event.code !== "Escape" || event.repeat) return;
    if (event.timeStamp - this.escaped < TWICE) {
      this.escaped = Number.NEGATIVE_INFINITY;
      this.emergency();
    } else {
      this.escaped = event.timeStamp;
      byId("said").textContent = "Escape again stops the drive";
    }
  }

  emergency() {
    this.tryTo(this.emergencyPlace, "emergency");
  }

  makeNote() {
    const input = make("input", { type: "text", maxLength: 2000, autocomplete: "off",
      placeholder: "Note; it is kept with the time", "aria-label": "Note" });
    const form = byId("note");
    form.append(input, make("button", { type: "submit" }, "Note"));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const text = input.value;
      if (await this.tryTo(form, "note", { text })) input.value = "";
    });
  }

  /** Only what makes sense now can be pressed. */
  show(state) {
    for (const { element, when } of this.places) element.disabled = !when(state);
  }
}
