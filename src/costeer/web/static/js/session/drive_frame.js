/**
 * The page of the drive, in a frame over the whole window while somebody drives.
 *
 * Its scene takes seconds to build. So it is built while the participant reads what comes
 * next, and kept, unseen, until the next drive. Only a frame that is seen takes the seat:
 * a second tab must not hold it.
 */

import { make } from "../elements.js";
import { words } from "./words.js";

export class DriveFrame {
  /** @param {URLSearchParams} given options of the view and token, passed on */
  constructor(given) {
    if (!given.has("clean")) given.set("clean", ""); // figures are for the experimenter
    const query = given.toString();
    this.address = `./drive${query ? `?${query}` : ""}`;
    this.frame = null;
    this.drive = "";
    addEventListener("focus", () => this.focus());
  }

  /** Keys go to the drive. */
  focus() {
    if (this.drive && document.activeElement === document.body) this.frame.focus();
  }

  /** What the page in the frame offers; undefined while it loads, or if it failed. */
  get page() {
    try {
      return this.frame?.contentWindow.costeer;
    } catch {
      return undefined; // the frame shows an error of the browser's
    }
  }

  /** Pictures a second that the drive is drawn with; undefined while nobody drives. */
  get pictures() {
    return this.drive && !this.isRefused ? this.page?.fps : undefined;
  }

  /** Whether another page drives already. */
  get isRefused() {
    return Boolean(this.drive) && this.page?.state === "refused";
  }

  /**
   * Show the frame as long as it is wanted, and never an old one for a new drive.
   * @param {object} state of the session
   * @param {boolean} isNear whether there is a drive to prepare the frame for
   * @param {boolean} isWanted whether somebody drives
   */
  update(state, isNear, isWanted) {
    const { participant, step } = state;
    const drive = isWanted ? `${participant}/${step.id}/${step.attempt}` : "";
    if (isNear && !this.frame) this.open(state);
    if (drive === this.drive) return;
    if (this.drive) this.rest();
    this.drive = drive;
    if (drive) this.show(state);
  }

  open(state) {
    this.frame = make("iframe", {
      id: "drive", title: words(state.texts, "session_title"), src: this.address, inert: true,
      allow: "fullscreen; gamepad",
    });
    const { frame } = this;
    frame.dataset.texts = toldOf(state);
    frame.dataset.lang = state.language;
    frame.addEventListener("load", () => {
      if (this.drive && frame === this.frame) frame.focus();
    });
    document.body.append(frame);
  }

  /** Let it be seen and driven; one that has failed, or has other words, is loaded again. */
  show(state) {
    if (this.hasFailed || this.frame?.dataset.texts !== toldOf(state)) this.close();
    if (!this.frame) this.open(state);
    this.frame.inert = false;
    document.body.classList.add("drives");
    this.page?.join?.(); // one that still loads joins by itself
    this.frame.focus();
  }

  /** Whether what was loaded before is no page of a drive: the server was not there. */
  get hasFailed() {
    return this.frame !== null && (!this.frame.contentDocument || this.page?.state === "failed");
  }

  /** Leave the seat; the scene stays for the next drive. */
  rest() {
    document.body.classList.remove("drives");
    if (!this.page?.rest) return this.close();
    this.page.rest();
    this.frame.inert = true;
    return undefined;
  }

  close() {
    this.frame?.remove();
    this.frame = null;
  }
}

/** What the page of the drive says to its participant. */
function toldOf({ texts, step }) {
  const waiting = texts[step.self_paced ? "drive_waiting_text" : "drive_held_text"];
  return JSON.stringify({ ...texts, drive_waiting_text: waiting });
}
