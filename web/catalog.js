// The list of layers, asked for until the server gives it.

const FIRST_WAIT_S = 1;
const LONGEST_WAIT_S = 15;

/**
 * The catalog; keeps asking while the server cannot be reached or is not ready. `say` is told in
 * words what is being waited for, and "" when there is nothing more to say.
 */
export async function load_catalog(url, say) {
  for (let wait = FIRST_WAIT_S; ; wait = Math.min(wait * 2, LONGEST_WAIT_S)) {
    const answer = await ask(url);
    if (answer.catalog) {
      say("");
      return answer.catalog;
    }
    const seconds = answer.retry_after ?? wait;
    say(`${answer.problem} Trying again in ${seconds} s.`);
    await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  }
}

async function ask(url) {
  let response;
  try {
    response = await fetch(url, { cache: "no-cache" });
  } catch {
    return { problem: "The server cannot be reached." };
  }
  if (response.status === 503) {
    return { problem: "The server is still reading its layers.", retry_after: retry_after(response) };
  }
  if (!response.ok) return { problem: `The server answered with status ${response.status}.` };
  try {
    const catalog = await response.json();
    if (Array.isArray(catalog?.layers)) return { catalog };
  } catch {
    // Told below: the connection may have broken off, or something else answers at this address.
  }
  return { problem: "The list of layers cannot be understood." };
}

function retry_after(response) {
  const seconds = Number.parseInt(response.headers.get("Retry-After") ?? "", 10);
  return Number.isFinite(seconds) ? Math.min(Math.max(seconds, 1), LONGEST_WAIT_S) : null;
}
