/**
 * Protocol: what server and page tell each other over the socket.
 */

/** Waits before a new attempt to connect [ms]. */
const RETRY = [500, 1000, 2000, 4000];

/** Longest list of latencies in a message. */
const MOST_LATENCIES = 60;

export class Link {
  /**
   * @param {string} address of the socket, ws: or wss:
   * @param {{hello: Function, frames: Function, text: Function, closed: Function}} handlers
   *   `frames(buffer, received)`, `text(message, received)`, `closed(reason, code)`.
   */
  constructor(address, handlers) {
    this.address = address;
    this.handlers = handlers;
    this.sequence = 0;
    this.attempts = 0;
    this.connected = false;
    /** Whether the server has said that it ends. */
    this.isOver = false;
    this.worker = new Worker(new URL("./socket_worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.connect();
  }

  connect() {
    this.worker.postMessage({ kind: "open", address: this.address });
  }

  receive(data) {
    if (data.kind === "frames") this.handlers.frames(data.buffer, data.received);
    else if (data.kind === "text") this.receiveText(data);
    else if (data.kind === "close") this.lost(data);
    else this.connected = true;
  }

  receiveText({ text, received }) {
    const message = JSON.parse(text);
    if (message.type !== "hello") return this.handlers.text(message, received);
    this.attempts = 0;
    return this.handlers.hello(message);
  }

  lost({ code, reason }) {
    this.connected = false;
    this.handlers.closed(reason, code);
    if (this.isOver) return;
    const wait = RETRY[Math.min(this.attempts++, RETRY.length - 1)];
    setTimeout(() => this.connect(), wait);
  }

  /** Send a message; nothing happens while there is no connection. */
  send(message) {
    if (this.connected) this.worker.postMessage({ kind: "send", text: JSON.stringify(message) });
  }

  /** Close the socket and never open it again. */
  close() {
    this.isOver = true;
    this.connected = false;
    this.worker.terminate();
  }

  /**
   * Send what hands and feet do; also the sign that this page lives.
   * @param {{steer: number, accelerator: number, brake: number}} controls
   * @returns {number} its sequence number
   */
  sendInput({ steer, accelerator, brake }) {
    this.sequence += 1;
    this.send({ type: "input", sequence: this.sequence, steer, accelerator, brake });
    return this.sequence;
  }

  /** Send measured latencies [ms]. */
  sendLatencies(values) {
    if (values.length > 0) {
      const rounded = values.slice(-MOST_LATENCIES).map((value) => Math.round(value * 10) / 10);
      this.send({ type: "latency", values: rounded });
    }
  }
}

/** Address of the socket beside this page. */
export function socketAddress(location, query) {
  const address = new URL(`./ws${query}`, location.href);
  address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  return address.href;
}
