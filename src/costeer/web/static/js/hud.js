/**
 * Head-up messages: what to do next, why nothing moves, and which key does what.
 */

import { byId, make } from "./elements.js";

/** What the page alone knows: how it stands with the server. */
export const LINK_STATES = {
  connecting: { name: "connecting", title: "Connecting …", lines: [] },
  lost: {
    name: "lost",
    title: "Connection lost",
    lines: ["The drive pauses. Trying again …", "If costeer drive has ended, start it again."],
    warns: true,
  },
  silent: {
    name: "silent",
    title: "The server does not answer",
    lines: ["The drive pauses. Waiting …"],
    warns: true,
  },
  over: {
    name: "over",
    title: "costeer drive has ended",
    lines: ["This page can be closed."],
  },
};

/** What lets a drive go on after a fault: never the key that starts it alone. */
const MENDED = "When it is mended press [C]; then [Enter] goes on.";

/** A page that the server has let go, and why. */
export const refused = (reason) => ({
  name: "refused", title: "This page does not drive", lines: [reason, "Trying again …"], warns: true,
});

/** Keys of driving and of replay, for the help. */
const DRIVING_KEYS = [
  [["←", "→", "A", "D"], "steer; the wheel under your hands feels the guidance"],
  [["↑", "↓"], "accelerator and brake"],
  [["Enter", "Space"], "start, or go on after a pause"],
  [["P"], "pause"],
  [["C"], "after a fault: it is mended"],
  [["Z", "X"], "indicator left, right; also , and ."],
  [["M"], "sound off or on"],
  [["+", "−"], "louder, softer"],
  [["S"], "show or hide the signals"],
  [["F"], "full screen"],
  [["H"], "show or hide this help"],
];
const EXPERIMENTER_KEYS = [[["E"], "show or hide the experimenter's panel"]];
const REPLAY_KEYS = [
  [["Space"], "play or stop"],
  [["←", "→"], "one frame back or on; with Shift one second"],
  [["↑", "↓"], "faster, slower"],
  [["Home", "End"], "to the beginning, to the end"],
  [["M"], "sound off or on"],
  [["+", "−"], "louder, softer"],
  [["S"], "show or hide the signals"],
  [["F"], "full screen"],
  [["H"], "show or hide this help"],
];

function keyList(lines) {
  const entries = lines.flatMap(([keys, meaning]) => {
    const caps = keys.flatMap((key) => [make("kbd", {}, key), " "]);
    return [make("dt", {}, ...caps), make("dd", {}, meaning)];
  });
  return make("dl", {}, ...entries);
}

export class Hud {
  /** @param {Record<string, string>} [texts] words of a session for its participant */
  constructor(texts) {
    this.texts = texts;
    this.banner = byId("banner");
    this.notice = byId("notice");
    this.help = byId("help");
    this.lost = byId("losses");
    this.shown = "";
    this.noticeTimer = 0;
  }

  /** Fill the help for a mode and a role. */
  describeKeys(mode, role) {
    const driving = role === "experimenter" ? [...DRIVING_KEYS, ...EXPERIMENTER_KEYS] : DRIVING_KEYS;
    const lines = mode === "replay" ? REPLAY_KEYS : driving;
    this.help.replaceChildren(make("h2", {}, "Keys"), keyList(lines));
  }

  toggleHelp() {
    if (this.texts) return; // a participant is told what to press, and no more
    this.help.hidden = !this.help.hidden;
  }

  /** Show a message in the middle until the next; nothing without a title. */
  message(title, lines = [], isWarning = false) {
    const wanted = JSON.stringify([title, lines, isWarning]);
    if (wanted === this.shown) return;
    this.shown = wanted;
    this.banner.hidden = !title;
    this.banner.classList.toggle("warn", isWarning);
    const paragraphs = lines.map((line) => make("p", {}, ...withKeys(line)));
    this.banner.replaceChildren(make("h1", {}, title ?? ""), ...paragraphs);
  }

  /**
   * Show the message that belongs to a state of the trial or of the link.
   * @param {{name: string, title: string, lines: string[], warns?: boolean}} state
   * @param {{text: string, can_resume: boolean, must_be_acknowledged: boolean}} [fault]
   *   what is wrong, if anything is
   */
  state(state, fault) {
    const { title, lines, warns = false } = state;
    if (this.texts) this.tellParticipant(state, fault);
    else if (!title || !fault?.text) this.message(title, lines, warns);
    else if (fault.must_be_acknowledged) this.message(title, [fault.text, MENDED], true);
    else this.message(title, fault.can_resume ? [fault.text, ...lines] : [fault.text], true);
  }

  /** In the participant's language; what to mend is for the experimenter's console. */
  tellParticipant({ name, title, warns = false }, fault) {
    const words = (part) => this.texts[`drive_${name}_${part}`] ?? "";
    const mayGoOn = !fault?.text || (fault.can_resume && !fault.must_be_acknowledged);
    if (!title) this.message(title);
    else if (mayGoOn) this.message(words("title"), [words("text")].filter(Boolean), warns);
    else if (name === "waiting") this.message(words("title"), [this.texts.wait_text], true);
    else this.message(words("title"), [this.texts.error_drive], true);
  }

  /** Show what the drive goes on without, as long as it does. */
  losses(texts) {
    if (this.texts) return; // the console tells them
    this.lost.hidden = texts.length === 0;
    this.lost.replaceChildren(...texts.map((text) => make("li", {}, text)));
  }

  /** Show a line at the bottom for a few seconds. */
  note(text, seconds = 4) {
    this.notice.textContent = text;
    this.notice.hidden = false;
    clearTimeout(this.noticeTimer);
    this.noticeTimer = setTimeout(() => {
      this.notice.hidden = true;
    }, seconds * 1000);
  }
}

/** Text whose words in brackets become keys. */
function withKeys(text) {
  return text.split(/(\[[^\]]+\])/).filter(Boolean).map((part) =>
    part.startsWith("[") ? make("kbd", {}, part.slice(1, -1)) : part,
  );
}

/** Fill the screen with the page, or leave it. */
export function toggleFullScreen() {
  if (document.fullscreenElement) document.exitFullscreen();
  else document.documentElement.requestFullscreen?.().catch(() => {});
}
