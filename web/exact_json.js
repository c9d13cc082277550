// JSON with integers that are too large for a JavaScript number, such as cells of a grid or hashes.

const TEXT_OR_NUMBER = /"(?:[^"\\]|\\.)*"|-?\d[\d.eE+-]*/g;

/** Like JSON.parse(), but integers that a number cannot hold exactly become strings. */
export function parse_exactly(text) {
  return JSON.parse(text.replaceAll(TEXT_OR_NUMBER, (found) =>
    (/^-?\d{16,}$/.test(found) && !Number.isSafeInteger(Number(found)) ? `"${found}"` : found)));
}
