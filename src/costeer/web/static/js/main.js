/**
 * The page: asks the server what it is for, then drives or replays.
 */

import { Drive } from "./drive.js";
import { byId } from "./elements.js";
import { Hud, LINK_STATES } from "./hud.js";
import { credentials, readOptions } from "./options.js";
import { Replay } from "./replay.js";

/** An answer of the server beside this page. */
async function ask(path, query) {
  const answer = await fetch(`./${path}${query}`);
  if (!answer.ok) throw new Error(`${path}: ${answer.status} ${await answer.text()}`);
  return answer;
}

/** What the page of a session that holds this one as a frame says to its participant. */
function sessionTexts() {
  const { texts, lang } = globalThis.frameElement?.dataset ?? {};
  if (!texts) return undefined;
  document.documentElement.lang = lang;
  return JSON.parse(texts);
}

async function start() {
  const options = readOptions(location.search);
  const query = credentials(location.search);
  const texts = sessionTexts();
  const hud = new Hud(texts);
  hud.state(LINK_STATES.connecting); // building the view holds everything up for a while
  const hello = await (await ask("api/hello", query)).json();
  if (hello.mode !== "replay") return new Drive(hello, options, query, texts);
  hud.message();
  const record = await (await ask("api/record", query)).arrayBuffer();
  return new Replay(hello, record, options);
}

start().then(
  (page) => Object.defineProperty(globalThis, "costeer", { get: () => page.report }),
  (error) => {
    globalThis.costeer = { state: "failed" };
    byId("counters").textContent = "";
    new Hud().message("The page could not start", [String(error.message ?? error)], true);
  },
);
