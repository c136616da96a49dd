/** A form of questions: draft, check, send, and what to do when sending fails. */

import { make } from "../elements.js";
import { openDraft } from "./draft.js";
import { makeField } from "./items.js";
import { makePairs } from "./pairs.js";
import { words } from "./words.js";

/**
 * Show a form.
 * @param {HTMLElement} root its content is replaced
 * @param {object} instrument the JSON of `rendered`
 * @param {Record<string, string>} texts words of the pages
 * @param {(answers: object) => Promise<unknown>} onSubmit rejects if the answers are
 *   not kept; an error may bear `problems`, a code by item
 * @param {{className?: string, submit?: string, buttons?: HTMLElement[]}} look
 */
export function renderForm(root, instrument, texts, onSubmit, look = {}) {
  const fields = makeFields(instrument, texts);
  const draft = openDraft(instrument.step);
  const alert = make("p", { class: "alert", role: "alert" });
  const send = make("button", { type: "submit", class: "main" },
    look.submit ?? words(texts, "form_submit"));
  const needsNote = instrument.items.some((item) => item.required);
  const form = make("form",
    { class: `questionnaire ${look.className ?? ""}`.trim(), noValidate: true,
      lang: instrument.language, "aria-labelledby": "form-title" },
    make("h1", { id: "form-title", tabIndex: -1 }, instrument.title),
    ...instrument.instruction.map((text) => make("p", { class: "instruction" }, text)),
    ...(needsNote ? [make("p", { class: "note" }, words(texts, "form_note"))] : []),
    ...fields.map((field) => field.element),
    alert,
    make("div", { class: "buttons" }, ...(look.buttons ?? []), send));

  const kept = draft.read();
  fields.forEach((field) => field.write(kept));
  let isSending = false;
  let wrong = new Set();

  form.addEventListener("input", (event) => {
    const field = fields.find(({ element }) => element.contains(event.target));
    field?.mark("");
    if (wrong.delete(field)) summarize();
    draft.keep(Object.assign({}, ...fields.map((each) => each.raw())));
  });
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (isSending) return;
    alert.textContent = "";
    if (tell(Object.assign({}, ...fields.map((field) => field.problems())))) return;
    setSending(true);
    try {
      await onSubmit(Object.assign({}, ...fields.map((field) => field.values())));
      draft.clear(); // the form stays shut: whoever is called shows what comes next
    } catch (error) {
      setSending(false);
      if (!tell(error?.problems ?? {})) {
        alert.textContent = words(texts, "error_send", { reason: error?.message ?? error });
        send.focus();
      }
    }
  });

  function setSending(on) {
    isSending = on;
    form.setAttribute("aria-busy", String(on));
    send.setAttribute("aria-disabled", String(on));
    send.textContent = on ? words(texts, "form_sending")
      : look.submit ?? words(texts, "form_submit");
  }

  /** Mark what is wrong, say how much it is, go to the first; whether anything is. */
  function tell(problems) {
    const byName = new Map(instrument.items.map((item) => [item.name, item]));
    wrong = new Set(fields.filter((field) => {
      const name = field.names.find((each) => problems[each]);
      const text = name ? words(texts, `error_${problems[name]}`, byName.get(name)) : "";
      field.mark(text);
      return text;
    }));
    if (!Object.keys(problems).length) return false;
    summarize();
    if (wrong.size === 0) alert.textContent = words(texts, "error_unknown");
    ([...wrong][0] ?? send).focus();
    return true;
  }

  /** Say how many answers are still wrong. */
  function summarize() {
    const count = wrong.size;
    alert.textContent = count === 0 ? ""
      : words(texts, count === 1 ? "error_summary_one" : "error_summary", { count });
  }

  root.replaceChildren(form);
  form.querySelector("h1").focus({ preventScroll: true });
  return form;
}

/** Fields of all items; comparisons are one field. */
function makeFields(instrument, texts) {
  const { items } = instrument;
  const pairs = items.filter((item) => item.kind === "pairs");
  const plain = items.filter((item) => item.kind !== "pairs");
  const fields = plain.map((item) => makeField(item, `item-${item.name}`, texts));
  return pairs.length ? [...fields, makePairs(pairs, items, "pairs", texts)] : fields;
}
