/** What the participant's page shows in each step. All text goes into text nodes. */

import { make } from "../elements.js";
import { renderConsent } from "./consent.js";
import { renderQuestionnaire } from "./questionnaire.js";
import { words } from "./words.js";

/**
 * Fill the page for a step.
 * @param {string} face which of `VIEWS`
 * @param {HTMLElement} root its content is replaced
 * @param {object} state of the session
 * @param {{next: Function, answer: Function, ready: Function, stop: Function, resume: Function,
 *   say: Function}} does
 * @returns {{update?: (state: object) => void}}
 */
export function viewOf(face, root, state, does) {
  return VIEWS[face](root, state, does) ?? {};
}

const VIEWS = {
  idle: (root, { texts }) => card(root, texts.wait_title, [texts.idle_text]),
  wait: (root, { texts }) => card(root, texts.wait_title, [texts.wait_text]),
  saving: (root, { texts }) => card(root, texts.wait_title, [texts.drive_saving]),
  done: (root, { texts }) => card(root, texts.done_title, [texts.done_text]),
  stopped,
  left: (root, { texts }) => card(root, texts.withdrawn_title, [texts.withdrawn_text]),
  instruct,
  ask: (root, { step, texts }, does) => {
    renderQuestionnaire(root, step.instrument, texts, does.answer);
  },
  consent,
  brief,
  frame: driving,
  break: rest,
};

/** Heading, paragraphs and what to press; the heading takes the focus and is read out. */
function card(root, title, texts, ...buttons) {
  const heading = make("h1", { tabIndex: -1 }, title);
  const paragraphs = texts.flatMap((text) => text.split(/\n+/)).filter(Boolean);
  root.replaceChildren(make("div", { class: "card" }, heading,
    ...paragraphs.map((text) => make("p", {}, text)),
    ...(buttons.length ? [make("div", { class: "buttons" }, ...buttons)] : [])));
  heading.focus({ preventScroll: true });
}

/** Title and text of a step of the plan. */
function headed({ step, texts, title }) {
  const values = { number: step.order, count: step.trials };
  const fill = (text) => words({ text }, "text", values);
  return [fill(step.title || title || words(texts, "session_title")), fill(step.text)];
}

/** A button that works once, until what it asked for has failed. */
function once(label, act) {
  const button = make("button", { type: "button", class: "main" }, label);
  button.addEventListener("click", async () => {
    if (button.getAttribute("aria-disabled") === "true") return;
    button.setAttribute("aria-disabled", "true");
    try {
      await act();
    } catch {
      button.removeAttribute("aria-disabled"); // the banner says why
    }
  });
  return button;
}

function instruct(root, state, does) {
  const [title, text] = headed(state);
  card(root, title, [text], once(words(state.texts, "form_submit"), does.next));
}

function consent(root, state, does) {
  renderConsent(root, state.step.instrument, state.texts, does.answer, () => does.stop(false));
}

/** Who has stopped may think better of it, as long as nobody else sits here. */
function stopped(root, { texts }, does) {
  card(root, texts.withdrawn_title, [texts.withdrawn_text],
    once(words(texts, "withdraw_cancel"), does.resume));
}

function brief(root, state, does) {
  const [title, text] = headed(state);
  card(root, title, [text], once(words(state.texts, "trial_start"), does.ready));
}

/** Beside the frame of the drive: the end of a practice that was long and good enough. */
function driving(root, { texts }, does) {
  const button = once(words(texts, "practice_enough"), does.next);
  const more = make("p", {}, words(texts, "practice_not_yet"));
  button.hidden = more.hidden = true;
  root.replaceChildren(make("div", { class: "enough" }, more, button));
  const show = (element, isShown) => {
    if (isShown && element.hidden) does.say(element.textContent);
    element.hidden = !isShown;
  };
  return {
    update: ({ step: { enough, criterion } }) => {
      const isMet = criterion?.met ?? true;
      show(button, enough && isMet);
      show(more, enough && !isMet);
    },
  };
}

function rest(root, state, does) {
  const { texts } = state;
  const left = make("p", { role: "timer", class: "left" });
  const button = once(words(texts, "break_continue"), does.next);
  const [title, text] = headed(state);
  card(root, title, [text], button);
  button.parentElement.before(left);
  button.hidden = true;
  return {
    update: ({ step }) => {
      const isOver = step.remaining <= 0;
      left.hidden = isOver;
      left.textContent = words(texts, "break_remaining", { time: clock(step.remaining) });
      if (isOver && button.hidden) does.say(words(texts, "break_continue"));
      button.hidden = !isOver;
    },
  };
}

/** Time as minutes and seconds. */
function clock(seconds) {
  const whole = Math.ceil(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
