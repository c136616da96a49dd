/** The lists of the console: participants, checks, trials, orders, log. */

import { byId, make, shownNumber } from "../elements.js";
import { askFirst } from "./dialog.js";

/** A panel that is filled anew only when what it shows has changed. */
function panel(id, title) {
  const body = make("div", {});
  const element = make("section", { class: "panel", id, "aria-label": title },
    make("h2", {}, title), body);
  let shown = "";
  return {
    element,
    fill: (data, children) => {
      const key = JSON.stringify(data);
      if (key === shown) return;
      shown = key;
      const held = document.activeElement?.dataset?.key;
      body.replaceChildren(...children(data));
      if (held) body.querySelector(`[data-key="${CSS.escape(held)}"]`)?.focus();
    },
  };
}

function button(label, key, onclick) {
  const element = make("button", { type: "button", onclick }, label);
  element.dataset.key = key;
  return element;
}

/** The next pseudonym after those that are taken: P01, P02, ... */
export function nextPseudonym(taken) {
  const numbers = taken.map((name) => Number(name.match(/\d+$/)?.[0] ?? 0));
  const prefix = taken.at(-1)?.match(/^\D*/)[0] ?? "P";
  return `${prefix}${String(Math.max(0, ...numbers) + 1).padStart(2, "0")}`;
}

export class Panels {
  /**
   * @param {(action: string, body?: object) => Promise<object>} act
   * @param {import("./actions.js").Actions} actions
   */
  constructor(act, actions) {
    this.act = act;
    this.actions = actions;
    this.people = panel("people", "Participants");
    this.checks = panel("checks", "Devices");
    this.trials = panel("trials", "Drives");
    this.orders = panel("orders", "Balance of orders");
    this.log = panel("events", "Log");
    byId("left").append(this.beginPanel(), this.people.element, this.orders.element);
    byId("right").append(this.checks.element, this.trials.element, this.log.element);
    this.makeCheck();
  }

  beginPanel() {
    this.pseudonym = make("input", { type: "text", autocomplete: "off", "aria-label": "Pseudonym" });
    this.pseudonym.addEventListener("input", () => {
      this.isTyped = this.pseudonym.value !== "";
    });
    this.language = make("select", { "aria-label": "Language" });
    const form = make("form", { class: "panel", id: "begin" }, make("h2", {}, "New participant"),
      make("div", { class: "row" }, this.pseudonym, this.language,
        make("button", { type: "submit", class: "main" }, "Begin")));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const given = { participant: this.pseudonym.value, language: this.language.value };
      if (await this.actions.tryTo(form, "begin", given)) this.isTyped = false;
    });
    return form;
  }

  makeCheck() {
    const press = make("button", { type: "button", id: "check" }, "Check");
    press.addEventListener("click", async () => {
      press.disabled = true;
      press.textContent = "Checking …";
      await this.actions.tryTo(this.checks.element, "check");
      press.disabled = false;
      press.textContent = "Check";
    });
    const title = this.checks.element.firstElementChild;
    const head = make("div", { class: "head" });
    title.replaceWith(head);
    head.append(title, press);
  }

  show(state) {
    this.showBegin(state);
    const { people, participant, planned, withdrawn } = state;
    this.people.fill({ people, participant, planned, withdrawn }, (data) => this.peopleRows(data));
    this.checks.fill(state.checks, checkRows);
    this.trials.fill(state.attempts, (attempts) => this.trialRows(attempts));
    this.orders.fill(state.balance, orderRows);
    this.log.fill(state.events, eventRows);
  }

  showBegin({ people, languages, language }) {
    if (this.language.options.length !== languages.length) {
      this.language.replaceChildren(...languages.map((each) => make("option", { value: each }, each)));
      this.language.value = language;
    }
    const proposal = nextPseudonym(people.map(({ participant }) => participant));
    if (!this.isTyped && document.activeElement !== this.pseudonym) this.pseudonym.value = proposal;
  }

  peopleRows({ people, participant, planned, withdrawn }) {
    const counted = people.filter(({ status }) => status === "finished").length;
    const gone = withdrawn ? `, ${withdrawn} withdrew` : "";
    const rows = people.map((one) => this.person(one, one.participant === participant));
    return [make("p", {}, `${counted} of ${planned} finished${gone}`), make("ul", {}, ...rows)];
  }

  person({ participant, slot, status, reason, number, of }, isHere) {
    const told = { active: `step ${number} of ${of}`, finished: "finished" }[status] ?? status;
    const row = make("li", { class: isHere ? "here" : "", title: reason || `row ${slot} of the orders` },
      make("div", { class: "line" }, make("b", {}, participant),
        make("span", {}, isHere ? `here, ${told}` : told)));
    const body = { participant };
    const press = (label, act) => button(label, `${label} ${participant}`, act);
    const buttons = [];
    if (isHere) buttons.push(press("Leave", () => this.actions.tryTo(row, "leave")));
    const hasStopped = status === "stopped" || status === "declined";
    const mayGoOn = hasStopped || (status === "active" && !isHere);
    if (mayGoOn) buttons.push(press("Go on", () => this.actions.tryTo(row, "begin", body)));
    if (status === "active" || status === "stopped") buttons.push(press("Replace …", () => this.askReplace(participant)));
    buttons.push(press("Withdraw …", () => this.askWithdraw(participant)));
    row.append(make("div", { class: "row" }, ...buttons));
    return row;
  }

  askReplace(participant) {
    askFirst({
      title: `Replace ${participant}?`, yes: "Count out",
      text: "The data stay, but do not count. The next new participant takes the same order of trials.",
      fields: [{ name: "reason", label: "Reason" }],
    }, ({ reason }) => this.act("replace", { participant, reason }));
  }

  askWithdraw(participant) {
    askFirst({
      title: `Delete everything of ${participant}?`, yes: "Delete for ever",
      text: "Answers, drives, notes and log are deleted and cannot be restored. A count stays.",
      fields: [{ name: "confirm", label: `Type ${participant} to confirm` }],
    }, ({ confirm }) => this.act("withdraw", { participant, confirm }));
  }

  trialRows(attempts) {
    if (attempts.length === 0) return [make("p", {}, "No drive yet.")];
    const heads = ["drive", "SDLP [m]", "SWRR [/min]", "speed [km/h]", ""];
    const head = make("tr", {}, ...heads.map((name) => make("th", { scope: "col" }, name)));
    const rows = attempts.toReversed().flatMap((one) => this.trialRow(one));
    return [make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows))];
  }

  trialRow({ step, attempt, kind, condition, order, state, reason, excluded, measures }) {
    const name = kind === "practise" ? `practice, ${condition}` : `${order}. ${condition}`;
    const told = attempt > 1 ? `${name} (${attempt})` : name;
    const isWhole = state === "finished";
    const action = excluded ? "include" : "exclude";
    const label = excluded ? "Include" : "Exclude";
    const press = button(label, `${action} ${step} ${attempt}`, () => askFirst({
      title: `${action === "exclude" ? "Exclude" : "Include"} ${told}?`, yes: label,
      fields: [{ name: "reason", label: "Reason" }],
    }, (given) => this.act(action, { step, attempt, ...given })));
    const values = isWhole
      ? [number(measures.sdlp, 2), number(measures.swrr, 1), number(measures.mean_speed, 0, 3.6)]
      : [state];
    const row = make("tr", { class: excluded ? "out" : "" },
      ...[told, ...values].map((text) => make("td", {}, text)),
      ...(isWhole ? [] : [make("td", { colSpan: 2 })]),
      make("td", {}, ...(isWhole && kind === "drive" ? [press] : [])));
    if (!reason) return [row];
    return [row, make("tr", {}, make("td", { colSpan: 5, class: "why" }, reason))];
  }
}

function number(value, digits, factor = 1) {
  return typeof value === "number" ? shownNumber(value * factor, digits) : "–";
}

function checkRows(checks) {
  if (checks.length === 0) return [make("p", {}, "Press Check before the first participant.")];
  return [make("ul", {}, ...checks.map(({ name, well, told }) => make("li",
    { class: well ? "" : "wrong", title: told },
    make("b", { class: well ? "good" : "bad" }, well ? "✓" : "✗"), ` ${name}`,
    make("span", { class: "unseen" }, well ? " is well" : " is not well"),
    ...(well ? [] : [make("small", {}, told)]))))];
}

function orderRows({ places, even }) {
  const names = Object.keys(places);
  if (names.length === 0) return [make("p", {}, "The plan has no block of trials.")];
  const heads = ["condition", ...names.map((_, n) => String(n + 1))];
  const body = names.map((name) => make("tr", {},
    ...[name, ...places[name].map(String)].map((text) => make("td", {}, text))));
  const told = even ? "Balanced: every condition has been in every place equally often."
    : "Not balanced yet: how often each condition was the 1st, 2nd, … trial.";
  return [make("p", { class: even ? "good" : "" }, told), make("table", {},
    make("thead", {}, make("tr", {}, ...heads.map((text) => make("th", { scope: "col" }, text)))),
    make("tbody", {}, ...body))];
}

function eventRows(events) {
  return [make("ul", {}, ...events.map(({ utc, kind, step, text }) => make("li", {},
    make("time", { dateTime: utc }, new Date(utc).toLocaleTimeString("en-GB")),
    make("span", {}, [kind, step, text].filter(Boolean).join(" · ")))))];
}
