/** The page of the drive, in a frame over the whole window while somebody drives. */

import { make } from "../elements.js";
import { words } from "./words.js";

export class DriveFrame {
  /** @param {URLSearchParams} given options of the view and token, passed on */
  constructor(given) {
    if (!given.has("clean")) given.set("clean", ""); // figures are for the experimenter
    const query = given.toString();
    this.address = `./drive${query ? `?${query}` : ""}`;
    this.frame = null;
    addEventListener("focus", () => this.focus());
  }

  /** Keys go to the drive. */
  focus() {
    if (this.frame && document.activeElement === document.body) this.frame.focus();
  }

  /** Whether another page drives already. */
  get isRefused() {
    try {
      return this.frame?.contentWindow.costeer?.state === "refused";
    } catch {
      return false; // the frame shows an error of the browser's
    }
  }

  /** Show the frame as long as it is wanted, and never an old one for a new drive. */
  update(state, isWanted) {
    const drive = isWanted ? `${state.participant}/${state.step.id}` : "";
    if (drive !== this.drive) this.close();
    if (drive && !this.frame) this.open(state);
    this.drive = drive;
  }

  open(state) {
    this.frame = make("iframe", {
      id: "drive", title: words(state.texts, "session_title"), src: this.address,
      allow: "fullscreen; gamepad",
    });
    const { texts, step } = state;
    const waiting = texts[step.self_paced ? "drive_waiting_text" : "drive_held_text"];
    this.frame.dataset.texts = JSON.stringify({ ...texts, drive_waiting_text: waiting });
    this.frame.dataset.lang = state.language;
    this.frame.addEventListener("load", () => this.frame?.focus());
    document.body.classList.add("drives");
    document.body.append(this.frame);
    this.frame.focus();
  }

  close() {
    this.frame?.remove();
    this.frame = null;
    document.body.classList.remove("drives");
  }
}
