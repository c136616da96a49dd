/**
 * Happenings: what a scenario does to who drives, in words and sounds.
 */

import { now } from "./clock.js";

const RUMBLE_STRIP = 1;
const BARRIER = 2;
const NOT_RUNNING = -1;

const WORDS = { left: "Change to the left lane", right: "Change to the right lane" };

export class Happenings {
  /**
   * @param {import("./hud.js").Hud} hud
   * @param {import("./sound.js").Sound} sound
   */
  constructor(hud, sound) {
    [this.hud, this.sound] = [hud, sound];
    for (const gesture of ["keydown", "pointerdown"]) addEventListener(gesture, () => sound.wake());
    this.greet({});
  }

  /** Take over what the server says of contacts and of the scenario. */
  greet(hello) {
    this.contacts = new Map((hello.contacts ?? []).map((row) => [row.code, row]));
    this.events = hello.scenario?.events ?? [];
    this.restarts = hello.scenario?.after_collision === "restart";
    this.before = { contact: 0, event: undefined };
  }

  /** Do what a key commands of the sound; tell whether it is such a key. */
  command(code, key) {
    if (code === "KeyM") this.hud.note(this.sound.toggle(), 2);
    else if (key === "+" || key === "-") this.hud.note(this.sound.change(key === "+" ? 1 : -1), 2);
    else return false;
    return true;
  }

  /** A state of the trial that has ended by a collision says so. */
  state(state, contact) {
    if (state?.name !== "ended" || !(contact >= BARRIER)) return state;
    const next = this.restarts ? ["The next drive is being prepared."] : [];
    return { ...state, title: "Collision", lines: [this.contacts.get(contact)?.text ?? "", ...next], warns: true };
  }

  /**
   * Look at a state.
   * @param {(name: string) => number} value of a column, 0 where there is none
   * @param {{isRunning: boolean, warns: boolean}} trial
   */
  see(value, { isRunning, warns }) {
    const [contact, position] = [value("contact"), value("longitudinal_position")];
    const event = isRunning
      ? this.events.findIndex(([kind, from, to]) => kind === "lane-change" && position >= from && position < to)
      : NOT_RUNNING;
    if (contact === RUMBLE_STRIP && this.before.contact !== contact) this.tell(this.contacts.get(contact)?.text);
    if (event >= 0 && event !== this.before.event) this.tell(WORDS[this.events[event][3]]);
    this.before = { contact, event };
    this.sound.update({
      speed: value("longitudinal_velocity"), accelerator: value("accelerator"), contact,
      indicator: value("indicator"), isRunning, warns, time: now(),
    });
  }

  /** Words for a driver; a participant of a session is told in the session's own. */
  tell(text) {
    if (text && !this.hud.texts) this.hud.note(text, 3);
  }
}
