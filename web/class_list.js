// Parses and formats the parameter `classes`, value:colour,...

/**
 * @typedef {{kind: "value"|"null"|"others", value: string, colour: string}} ColourClass
 *   `value` is "" unless the kind is "value"
 */

const QUOTED = /^'((?:[^']|'')*)':/;
const PLAIN = /^([^':,][^:,]*):/;
const COLOUR = /^([^,(]*(?:\([^)]*\)[^,]*)?)(?:,(?=.)|$)/;

/** @returns {?ColourClass[]} null if `text` is not a list of classes */
export function parse_classes(text) {
  const classes = [];
  for (let rest = text; rest !== "";) {
    const quoted = QUOTED.exec(rest);
    const found = quoted ?? PLAIN.exec(rest);
    if (!found) return null;
    rest = rest.slice(found[0].length);
    const colour = COLOUR.exec(rest);
    if (!colour || colour[1] === "") return null;
    rest = rest.slice(colour[0].length);
    classes.push({ ...read_value(found[1], quoted !== null), colour: colour[1] });
  }
  return classes;
}

export function format_classes(classes) {
  return classes.map(({ kind, value, colour }) => `${write_value(kind, value)}:${colour}`).join(",");
}

/** Whether eight such values fit into an address, which has no control characters. */
export function can_be_class(value) {
  return !/\p{Cc}/u.test(value) && encodeURIComponent(value).length <= 360;
}

function read_value(text, is_quoted) {
  if (is_quoted) return { kind: "value", value: text.replaceAll("''", "'") };
  if (text === "*") return { kind: "others", value: "" };
  if (text === "null") return { kind: "null", value: "" };
  return { kind: "value", value: text };
}

function write_value(kind, value) {
  if (kind === "others") return "*";
  if (kind === "null") return "null";
  const is_plain = value !== "" && value !== "*" && value !== "null" && !/[',:]/.test(value);
  return is_plain ? value : `'${value.replaceAll("'", "''")}'`;
}
