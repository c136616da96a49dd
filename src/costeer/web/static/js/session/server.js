/** Requests of a page of the session, and the state that comes with the answers. */

/** Longest wait for an answer [ms]; then the server counts as lost. */
const PATIENCE = 8000;

/** An answer that refuses something; `answer` is what the server said with it. */
export class Refusal extends Error {
  constructor(status, answer) {
    super(answer.text ?? `The server answers ${status}.`);
    this.status = status;
    this.answer = answer;
    if (answer.problems) this.problems = answer.problems;
  }
}

/**
 * Ask the server; with a body it is a POST of JSON.
 * @returns {Promise<object>}
 * @throws {Refusal} if it refuses; another error if it cannot be reached
 */
export async function ask(path, query, body) {
  const options = { signal: AbortSignal.timeout(PATIENCE), cache: "no-store" };
  if (body !== undefined) {
    options.method = "POST";
    options.headers = { "Content-Type": "application/json" };
    options.body = JSON.stringify(body);
  }
  const answer = await fetch(`./${path}${query}`, options);
  const isJson = answer.headers.get("content-type")?.startsWith("application/json");
  const told = isJson ? await answer.json() : { text: (await answer.text()).trim() };
  if (!answer.ok) throw new Refusal(answer.status, told);
  return told;
}

/**
 * Asks for the state again and again, and never shows an older one after a newer one.
 */
export class Follower {
  /**
   * @param {() => Promise<object>} get asks for the state
   * @param {{take: Function, lost: Function, pause: () => number}} handlers `take(state, ms)`,
   *   `lost(error)`; `pause` is the time until the next question [ms]
   */
  constructor(get, handlers) {
    this.get = get;
    this.handlers = handlers;
    this.asked = 0;
    this.shown = 0;
    this.timer = 0;
  }

  /** Ask once, and then again and again. */
  async follow() {
    clearTimeout(this.timer);
    await this.send(this.get).catch(() => {});
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.follow(), this.handlers.pause());
  }

  /** Send a question whose answer is the state, too. */
  async send(question) {
    const number = ++this.asked;
    const start = performance.now();
    try {
      const state = await question();
      this.take(number, state, performance.now() - start);
      return state;
    } catch (error) {
      if (!(error instanceof Refusal)) this.handlers.lost(error);
      else if (error.answer.state) this.take(number, error.answer.state, 0);
      else if (question === this.get) this.handlers.lost(error);
      throw error;
    }
  }

  take(number, state, duration) {
    if (number < this.shown) return; // a newer one is on show
    this.shown = number;
    this.handlers.take(state, duration);
  }
}
