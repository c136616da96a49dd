/** Answers that are not sent yet, kept in this tab so that a reload loses none. */

const PREFIX = "costeer.draft.";

/**
 * The draft of one step. Drafts of other steps are dropped: they may be another
 * participant's.
 * @param {string} step names the step, and no other one in the study
 */
export function openDraft(step) {
  const key = PREFIX + step;
  forget((name) => name.startsWith(PREFIX) && name !== key);
  return {
    read: () => {
      try {
        const found = JSON.parse(sessionStorage.getItem(key) ?? "{}");
        return found && typeof found === "object" ? found : {};
      } catch {
        return {}; // storage is shut off, or holds what we never wrote
      }
    },
    keep: (raw) => {
      try {
        sessionStorage.setItem(key, JSON.stringify(raw));
      } catch {
        // storage is full or shut off: the answers are still on the page
      }
    },
    clear: () => forget((name) => name === key),
  };
}

function forget(isMeant) {
  try {
    for (const name of Object.keys(sessionStorage)) {
      if (isMeant(name)) sessionStorage.removeItem(name);
    }
  } catch {
    // shut off: then there is nothing to forget
  }
}
