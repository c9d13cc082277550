// Tracks whether the server responds. If it does not, retries with growing pauses until it does.

const FIRST_PAUSE_S = 1;
const LONGEST_PAUSE_S = 30;
const LOADING_PAUSE_S = 1; // keeps the percentage current
const JITTER = 0.2; // spreads the retries of pages that lost the server at the same time
const ANSWER_MS = 15_000;
const MOST_NAMED = 6;
const QUIET_FAILURES = 1; // not reported while the server is there
const AWAY = ["lost", "loading"];
const GATEWAY = [502, 504]; // a proxy reports that the server behind it does not respond

export class Connection {
  /**
   * @param base address of the server's folder
   * @param on {tell(text, {aside, bars, action}), back(was_away), refused(url, problem)}: shows a message, ""
   *   for none; the server responds again; it refuses `url`, with the reason {status, detail, parameter}
   */
  constructor(base, on) {
    this.base_ = base;
    this.on_ = on;
    this.failures_ = 0;
    this.failed_ = new Set(); // addresses
    this.is_waiting_ = false;
    this.wake_ = () => {};
    window.addEventListener("online", () => this.wake_());
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "visible") this.wake_();
    });
  }

  /** A request succeeded: resets the failure count. */
  worked() {
    if (!this.is_waiting_) this.failures_ = 0;
  }

  /** Loading the image at `url` failed: finds out why, waits, and calls back. */
  async failed(url) {
    this.failed_.add(url);
    if (this.is_waiting_) return;
    this.is_waiting_ = true;
    let was_away = false;
    for (const one of this.failed_) {
      const trouble = await trouble_at(one);
      this.failed_.delete(one);
      if (trouble?.kind === "refused") {
        this.on_.refused(one, trouble);
        continue;
      }
      was_away ||= AWAY.includes(trouble?.kind);
      await this.until_better_(trouble ?? { kind: "unclear" });
      this.failed_.clear(); // all of them are requested again
    }
    this.is_waiting_ = false;
    this.on_.back(was_away);
  }

  /** Waits once, or for as long as the server is away; for callers that send the request themselves. */
  async after(trouble) {
    this.is_waiting_ = true;
    await this.until_better_(trouble);
    this.is_waiting_ = false;
  }

  /** Nothing is pending any more: clears the message. */
  hush() {
    this.failures_ = 0;
    this.on_.tell("");
  }

  async until_better_(first) {
    let trouble = first;
    if (trouble.kind === "busy" || trouble.kind === "loading") {
      trouble = (await this.trouble_of_ready_()) ?? trouble;
    }
    // At least one pause: otherwise requests that fail while the server is up would repeat in a busy loop.
    do {
      await this.pause_(trouble);
      const now = await this.trouble_of_ready_();
      trouble = now && now.kind !== "refused" ? now : null;
    } while (trouble !== null);
    this.on_.tell("");
  }

  async pause_(trouble) {
    const seconds = this.seconds_(trouble);
    const is_soon_over = !trouble.words && ["busy", "unclear"].includes(trouble.kind);
    const words = is_soon_over && this.failures_ <= QUIET_FAILURES ? "" : words_for(trouble);
    const end = performance.now() + 1000 * seconds;
    let is_awake = false;
    const pressed = new Promise((resolve) => {
      this.wake_ = () => {
        is_awake = true;
        resolve();
      };
    });
    for (let left = seconds; left > 0 && !is_awake; left = (end - performance.now()) / 1000) {
      // Does not show the same number of seconds again for a remaining fraction.
      const told = Math.max(1, Math.ceil(left - 0.05));
      if (words) this.on_.tell(words, this.more_(trouble, told));
      await Promise.race([pressed, sleep(Math.min(1000 * left, 1000 * (left - told + 1) + 10))]);
    }
    this.wake_ = () => {};
  }

  more_({ kind, layers = [] }, seconds) {
    if (kind === "loading") return progress_of(layers);
    const aside = `Trying again in ${seconds} s.`;
    return { aside, action: kind === "lost" ? ["Try now", () => this.wake_()] : undefined };
  }

  seconds_({ kind, retry_after }) {
    if (kind === "loading") return retry_after ?? LOADING_PAUSE_S;
    const growing = Math.min(FIRST_PAUSE_S * 2 ** this.failures_, LONGEST_PAUSE_S);
    this.failures_++;
    // Jitter never shortens the pause that the server requested.
    return Math.max(growing, retry_after ?? 0) * (1 + JITTER * Math.random());
  }

  /** null if the server is ready, or does not report readiness. */
  async trouble_of_ready_() {
    const trouble = await trouble_at(new URL("ready", this.base_));
    if (trouble?.kind !== "busy") return trouble;
    return { ...trouble, kind: "loading" };
  }
}

/** Why `url` cannot be loaded: {kind: "lost", "busy" or "refused", ...}; null if it can. */
export async function trouble_at(url) {
  let response;
  try {
    response = await fetch(url, { cache: "no-store", signal: AbortSignal.timeout(ANSWER_MS) });
  } catch {
    return { kind: "lost" };
  }
  return trouble_in(response);
}

/** The same for a response that has arrived. */
export async function trouble_in(response) {
  const { status } = response;
  if (response.ok) {
    response.body?.cancel();
    return null;
  }
  if (GATEWAY.includes(status)) return { kind: "lost", status };
  const told = await response.json().catch(() => null);
  const trouble = {
    status,
    detail: typeof told?.detail === "string" ? told.detail : "",
    parameter: told?.parameter,
    retry_after: retry_after(response),
    layers: layers_in(told),
  };
  if (status === 503) return { ...trouble, kind: told?.status === "loading" ? "loading" : "busy" };
  if (status === 429) return { ...trouble, kind: "busy" };
  return { ...trouble, kind: status >= 500 ? "unclear" : "refused" };
}

function layers_in(told) {
  if (!Array.isArray(told?.layers)) return [];
  return told.layers.filter((layer) => typeof layer?.name === "string");
}

function retry_after(response) {
  const seconds = Number.parseInt(response.headers.get("Retry-After") ?? "", 10);
  return Number.isFinite(seconds) ? Math.min(Math.max(seconds, 1), LONGEST_PAUSE_S) : null;
}

function words_for({ kind, words, status }) {
  if (words) return words;
  if (kind === "lost") return "The server cannot be reached.";
  if (kind === "loading") return "The server is still reading its layers.";
  if (kind === "busy") {
    return status === 429 ? "Too many requests for the server."
      : "The server is busy.";
  }
  return "Some tiles could not be loaded.";
}

/** The layers that are loading, with their progress; finished layers make room for others. */
function progress_of(layers) {
  const open = layers.filter(({ percent }) => Number.isFinite(percent) && percent < 100);
  const bars = open.slice(0, MOST_NAMED).map(({ name, title, percent }) =>
    ({ name: String(title || name), percent: Math.max(0, Math.floor(percent)) }));
  const told = bars.map(({ name, percent }) => `${name} ${percent} %`);
  const more = open.length > bars.length ? `and ${open.length - bars.length} more` : "";
  return { aside: [...told, more].filter(Boolean).join(", "), bars, more };
}

function sleep(ms) {
  return new Promise((resolve) => setTimeout(resolve, ms));
}
