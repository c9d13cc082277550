// Converts colours from the syntax of the parameters (hex digits without '#', CSS names, rgb and rgba) to
// that of the browser.

// Distinguishable with any kind of colour blindness: Paul Tol's light scheme.
export const CLASS_COLOURS = ["77aadd", "ee8866", "eedd88", "ffaabb", "99ddff", "44bb99", "bbcc33",
  "aaaa00"];
export const COLOUR_OF_OTHERS = "d9dde2";

const GOLDEN_ANGLE = 137.50776405003785; // hue step that keeps any number of hues distinct
const MIDDLES = [176, 194, 158, 185]; // of the channels: similar hues differ in lightness
const REACH = 56; // deviation from the middle

/** A light colour for the item at `position`, distinct for every position. */
export function light_colour_at(position) {
  if (position < CLASS_COLOURS.length) return CLASS_COLOURS[position];
  const middle = MIDDLES[position % MIDDLES.length];
  const channel = (turned) => {
    const radians = ((position * GOLDEN_ANGLE - turned) * Math.PI) / 180;
    return Math.round(middle + REACH * Math.cos(radians)).toString(16).padStart(2, "0");
  };
  return channel(0) + channel(120) + channel(240);
}

/** For a style sheet; an invalid colour does no harm there. */
export function css_of(colour) {
  return /^[0-9a-f]+$/i.test(colour) ? `#${colour}` : colour;
}

let canvas = null;

/** Six hex digits, without the alpha channel, which a colour input cannot show. */
export function rgb_of(colour) {
  if (/^[0-9a-f]{6}$/i.test(colour)) return colour.toLowerCase();
  canvas ??= new OffscreenCanvas(1, 1).getContext("2d");
  canvas.fillStyle = "#000"; // unchanged if `colour` is invalid
  canvas.fillStyle = css_of(colour);
  const parsed = canvas.fillStyle;
  if (parsed.startsWith("#")) return parsed.slice(1);
  const numbers = parsed.match(/\d+/g)?.slice(0, 3).map(Number) ?? [0, 0, 0];
  return numbers.map((number) => number.toString(16).padStart(2, "0")).join("");
}
