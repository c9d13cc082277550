// Colours as the parameters write them (hex digits without '#', CSS names, rgb and rgba), and as
// the browser wants them.

// Told apart, quiet, readable beside each other.
export const CLASS_COLOURS = ["4c8c6b", "d08a3e", "7a6fb0", "b9524e", "5b9bd5", "b0a04a", "8c6d54",
  "5fa7a0", "c77aa8", "7f8c99"];
export const COLOUR_OF_OTHERS = "d9dde2";

/** For a style sheet; what is no colour is no danger there. */
export function css_of(colour) {
  return /^[0-9a-f]+$/i.test(colour) ? `#${colour}` : colour;
}

/** Six hex digits, without the transparency, which a colour input cannot show. */
export function rgb_of(colour) {
  const canvas = new OffscreenCanvas(1, 1);
  const context = canvas.getContext("2d");
  context.fillStyle = css_of(colour); // stays black if it is none
  const parsed = context.fillStyle;
  if (parsed.startsWith("#")) return parsed.slice(1);
  const numbers = parsed.match(/\d+/g)?.slice(0, 3).map(Number) ?? [0, 0, 0];
  return numbers.map((number) => number.toString(16).padStart(2, "0")).join("");
}
