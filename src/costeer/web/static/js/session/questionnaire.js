/** A questionnaire on the participant's page. */

import { renderForm } from "./form.js";

/**
 * Show a questionnaire.
 * @param {HTMLElement} root its content is replaced
 * @param {object} instrument the JSON of `rendered` of instrument.py
 * @param {Record<string, string>} texts `Texts.pages` of texts.py
 * @param {(answers: Record<string, number|string>) => Promise<unknown>} onSubmit called
 *   with one value by item when all is answered. If it rejects, the answers stay and the
 *   error is shown: its `problems`, a code by item as `AnswersError.codes()` has them, or
 *   its message.
 * @returns {HTMLFormElement}
 */
export function renderQuestionnaire(root, instrument, texts, onSubmit) {
  return renderForm(root, instrument, texts, onSubmit, { className: instrument.name });
}
