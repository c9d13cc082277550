// Colours as the parameters write them (hex digits without '#', CSS names, rgb and rgba), and as
// the browser wants them.

// Told apart by everybody, whichever colours the eye takes for each other: the light scheme of Paul Tol.
export const CLASS_COLOURS = ["77aadd", "ee8866", "eedd88", "ffaabb", "99ddff", "44bb99", "bbcc33",
  "aaaa00"];
export const COLOUR_OF_OTHERS = "d9dde2";

const GOLDEN_ANGLE = 137.50776405003785; // turned by it, hues stay apart however many there are
const MIDDLES = [176, 194, 158, 185]; // of the channels: what is near in hue is not as light
const REACH = 56; // how far they go from it

/** A light colour for the one at `position` of things that shall be told apart; none comes twice. */
export function light_colour_at(position) {
  if (position < CLASS_COLOURS.length) return CLASS_COLOURS[position];
  const middle = MIDDLES[position % MIDDLES.length];
  const channel = (turned) => {
    const radians = ((position * GOLDEN_ANGLE - turned) * Math.PI) / 180;
    return Math.round(middle + REACH * Math.cos(radians)).toString(16).padStart(2, "0");
  };
  return channel(0) + channel(120) + channel(240);
}

/** For a style sheet; what is no colour is no danger there. */
export function css_of(colour) {
  return /^[0-9a-f]+$/i.test(colour) ? `#${colour}` : colour;
}

let canvas = null;

/** Six hex digits, without the transparency, which a colour input cannot show. */
export function rgb_of(colour) {
  if (/^[0-9a-f]{6}$/i.test(colour)) return colour.toLowerCase();
  canvas ??= new OffscreenCanvas(1, 1).getContext("2d");
  canvas.fillStyle = "#000"; // stays so if it is none
  canvas.fillStyle = css_of(colour);
  const parsed = canvas.fillStyle;
  if (parsed.startsWith("#")) return parsed.slice(1);
  const numbers = parsed.match(/\d+/g)?.slice(0, 3).map(Number) ?? [0, 0, 0];
  return numbers.map((number) => number.toString(16).padStart(2, "0")).join("");
}
