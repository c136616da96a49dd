/** The participant's way out: a button in every step, and a question before it is done. */

import { byId, make } from "../elements.js";
import { words } from "./words.js";

export class Stopping {
  /** @param {(deletes: boolean) => Promise<unknown>} stop tells the server */
  constructor(stop) {
    this.stop = stop;
    this.button = byId("stop");
    this.dialog = byId("stopping");
    this.button.addEventListener("click", () => this.ask());
  }

  /** The button is there, except in steps that have no use for it. */
  show({ texts }, isHidden) {
    this.texts = texts;
    const label = words(texts, "withdraw_button");
    if (this.button.textContent !== label) this.button.textContent = label;
    this.button.hidden = isHidden;
    if (isHidden && this.dialog.open) this.dialog.close();
  }

  ask() {
    const word = (key) => words(this.texts, key);
    const deletes = make("input", { type: "checkbox" });
    const wrong = make("p", { class: "alert", role: "alert", hidden: true });
    const form = make("form", { method: "dialog", noValidate: true },
      make("h1", { id: "stopping-title" }, word("withdraw_title")), make("p", {}, word("withdraw_text")),
      make("label", {}, deletes, word("withdraw_delete")), wrong,
      make("div", { class: "buttons" },
        make("button", { type: "button", class: "main", onclick: () => this.dialog.close() },
          word("withdraw_cancel")),
        make("button", { type: "submit" }, word("withdraw_confirm"))));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        await this.stop(deletes.checked);
        this.dialog.close();
      } catch {
        wrong.textContent = word("error_connection");
        wrong.hidden = false;
      }
    });
    this.dialog.replaceChildren(form);
    this.dialog.showModal();
  }
}
