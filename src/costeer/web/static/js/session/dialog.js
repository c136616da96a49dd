/** Questions before an action that cannot be taken back, or that needs a reason. */

import { byId, make } from "../elements.js";

/**
 * Ask in a dialog.
 * @param {{title: string, text?: string, yes: string,
 *   fields?: {name: string, label: string, options?: string[], value?: string}[]}} question
 * @param {(answers: Record<string, string>) => Promise<unknown>} act does it; if it rejects,
 *   the reason is shown and the dialog stays
 */
export function askFirst({ title, text = "", yes, fields = [] }, act) {
  const dialog = byId("dialog");
  const inputs = fields.map(fieldOf);
  const wrong = make("p", { class: "error", role: "alert", hidden: true });
  const close = () => dialog.close();
  const form = make("form", { method: "dialog", noValidate: true },
    make("h2", { id: "dialog-title" }, title), ...(text ? [make("p", {}, text)] : []),
    ...inputs.map(({ label }) => label), wrong,
    make("div", { class: "buttons" },
      make("button", { type: "button", onclick: close }, "Cancel"),
      make("button", { type: "submit", class: "main" }, yes)));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await act(Object.fromEntries(inputs.map(({ name, input }) => [name, input.value])));
      close();
    } catch (error) {
      wrong.textContent = error.message;
      wrong.hidden = false;
    }
  });
  dialog.replaceChildren(form);
  dialog.showModal();
  (inputs[0]?.input ?? form.querySelector("button.main")).focus();
}

function fieldOf({ name, label, options, value = "" }) {
  const input = options ? make("select", {}) : make("input", { type: "text", autocomplete: "off" });
  if (options) input.append(...options.map((each) => make("option", { value: each }, each)));
  input.value = value;
  return { name, input, label: make("label", {}, label, input) };
}

/** A message beside what was pressed, until it is dismissed. */
export function errorBox(text) {
  const box = make("div", { class: "error", role: "alert" }, make("span", {}, text),
    make("button", { type: "button", "aria-label": "Dismiss", onclick: () => box.remove() }, "×"));
  return box;
}
