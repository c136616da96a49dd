/** Consent: a text to read, boxes to tick, and a way out. */

import { make } from "../elements.js";
import { renderForm } from "./form.js";
import { words } from "./words.js";

/**
 * Show the consent.
 * @param {HTMLElement} root its content is replaced
 * @param {object} instrument the JSON of `rendered`, with `version` and `hash` of its text
 * @param {Record<string, string>} texts words of the pages
 * @param {(answers: Record<string, string>) => Promise<unknown>} onSubmit as in
 *   `renderQuestionnaire`
 * @param {() => void} onDecline called when the person does not take part
 * @returns {HTMLFormElement}
 */
export function renderConsent(root, instrument, texts, onSubmit, onDecline) {
  const decline = make("button", { type: "button", onclick: () => onDecline() },
    words(texts, "consent_decline"));
  return renderForm(root, instrument, texts, onSubmit, {
    className: "consent",
    submit: words(texts, "consent_agree"),
    buttons: [decline],
  });
}
