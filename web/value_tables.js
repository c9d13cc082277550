// Tables of numbers from spreadsheets, and posting them to the server.

/** The column names of a pasted table, read as the server does; [] if there is no header line. */
export function columns_of(text) {
  const { header, delimiter } = header_of(text);
  const field = new RegExp(`${delimiter}(?:"((?:[^"]|"")*)"|([^${delimiter}]*))`, "g");
  const names = [...(delimiter + header).matchAll(field)].map(([, quoted, plain]) =>
    in_one_line(quoted?.replaceAll('""', '"') ?? plain).replace(/^[ \t]+|[ \t]+$/g, ""));
  return names.length > 1 ? names : [];
}

/** The first line that is not empty; in quotes, a line break belongs to a name. */
function header_of(text) {
  const table = text.replace(/^\uFEFF?[\r\n]*/, "");
  const [line] = /^(?:"[^"]*"?|[^"\r\n]+)*/.exec(table);
  const unquoted = line.replaceAll(/"[^"]*"?/g, "");
  const delimiter = ["\t", ";"].find((one) => unquoted.includes(one)) ?? ",";
  const field = `(?:"(?:[^"]|"")*"|[^${delimiter}\\r\\n]*)`;
  const [header] = new RegExp(`^${field}(?:${delimiter}${field})*`).exec(table);
  return { table, header, delimiter };
}

/** The table with each name in one line: the address names columns, and can have no line breaks. */
function with_short_names(text) {
  const { table, header } = header_of(text);
  return in_one_line(header) + table.slice(header.length);
}

function in_one_line(text) {
  return text.replaceAll(/[\r\n]+/g, " ");
}

/**
 * Posts a table, to be joined to a layer. @returns {table}: the response of POST /values; or {problem: a
 * user-readable message}.
 * @param columns {key, value}: their names
 * @param join the attribute of the layer that is the key
 */
export async function post_table(base, text, columns, layer, join) {
  const query = new URLSearchParams({ ...columns, layer, join });
  let response;
  try {
    response = await fetch(new URL(`values?${query}`, base), {
      method: "POST",
      headers: { "Content-Type": "text/csv; charset=utf-8" },
      body: with_short_names(text),
    });
  } catch {
    return { problem: "The server cannot be reached." };
  }
  const told = await response.json().catch(() => null);
  if (response.ok && typeof told?.id === "string") return { table: told };
  return {
    problem: typeof told?.detail === "string" ? told.detail
      : `The server answered with status ${response.status}.`,
  };
}

/** Describes in words how a table matches a layer. */
export function fit_in_words({ type, first_word, rows_without_key, joins }) {
  const { matched = 0, unmatched = 0, unmatched_keys = [], features_without_value = 0 } = joins?.[0] ?? {};
  const parts = [`${matched} ${matched === 1 ? "row matches" : "rows match"}.`];
  if (unmatched > 0) {
    const more = unmatched > unmatched_keys.length ? ", …" : "";
    parts.push(`${unmatched} ${unmatched === 1 ? "does" : "do"} not: ${unmatched_keys.join(", ")}${more}.`);
  }
  if (rows_without_key > 0) parts.push(`${rows_without_key} have no key.`);
  if (features_without_value > 0) parts.push(`${features_without_value} features have no value.`);
  if (type === "string") {
    parts.push(`The values are text, such as "${first_word}": only numbers can be classified here.`);
  }
  return parts.join(" ");
}
