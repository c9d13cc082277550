// Requests the list of layers until the server returns it.

import { trouble_in } from "./connection.js";

/** The catalog; uses `connection` to wait while the server cannot be reached or is not ready. */
export async function load_catalog(url, connection) {
  for (;;) {
    const { catalog, trouble } = await ask(url);
    if (catalog) {
      connection.hush();
      return catalog;
    }
    await connection.after(trouble);
  }
}

async function ask(url) {
  let response;
  try {
    response = await fetch(url, { cache: "no-cache" });
  } catch {
    return { trouble: { kind: "lost" } };
  }
  const trouble = await trouble_in(response.clone());
  if (trouble?.status === 503) return { trouble: { ...trouble, kind: "loading" } };
  if (trouble?.kind === "lost") return { trouble };
  if (trouble) return unclear(`The server answered with status ${response.status}.`);
  try {
    const catalog = await response.json();
    if (Array.isArray(catalog?.layers)) return { catalog };
  } catch {
    // Reported below: the connection may have broken, or something else responds at this address.
  }
  return unclear("The list of layers cannot be parsed.");
}

function unclear(words) {
  return { trouble: { kind: "unclear", words } };
}
