// Attribution lines from a server: text in which links are the only markup.

/**
 * The DOM nodes for `text`. The only markup kept is <a href="http(s)://...">; all other markup is reduced
 * to its text. Parsing into a separate document runs no script and loads nothing.
 */
export function attribution_nodes(text) {
  const body = new DOMParser().parseFromString(String(text), "text/html").body;
  return [...body.childNodes].flatMap(safe_nodes);
}

function safe_nodes(node) {
  if (node.nodeType === Node.TEXT_NODE) return [document.createTextNode(node.data)];
  if (node.nodeType !== Node.ELEMENT_NODE) return [];
  if (["SCRIPT", "STYLE", "TEMPLATE"].includes(node.tagName)) return [];
  const url = node.tagName === "A" ? web_url(node.getAttribute("href")) : null;
  if (!url) return [...node.childNodes].flatMap(safe_nodes);
  return [link_to(url, node.textContent)];
}

export function link_to(url, text) {
  const link = document.createElement("a");
  link.href = url;
  link.target = "_blank";
  link.rel = "noopener noreferrer";
  link.textContent = text;
  return link;
}

/** `href` if it is an absolute http(s) URL, else null. */
function web_url(href) {
  try {
    const url = new URL(href ?? "");
    return ["http:", "https:"].includes(url.protocol) ? url.href : null;
  } catch {
    return null;
  }
}
