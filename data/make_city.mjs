// Invents a city, so that there is something to see at every zoom: an island that is not there, on the
// Dogger Bank in the North Sea. Writes one layer of it as GeoJSON, one feature a line; always the same.
//
//   node make_city.mjs land|blocks|water|buildings FILE
//
// Lengths are in metres, east and north of the market square.
import { writeFileSync } from "node:fs";

const CENTRE = [2.35, 54.72];
const OLD_TOWN = 400;
const RINGS = [
  { from: 470, to: 1010, sectors: 12, block: 7500, kind: "closed" },
  { from: 1045, to: 1640, sectors: 18, block: 9500, kind: "open" },
  { from: 1665, to: 2350, sectors: 26, block: 12000, kind: "houses" },
];
const RIVER_HALF = 38;
const QUAY = 16;

let state = 20240229;
function random() {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}
const between = (low, high) => low + (high - low) * random();
const pick = (list) => list[Math.floor(random() * list.length)];

const minus = (a, b) => [a[0] - b[0], a[1] - b[1]];
const along = (p, d, t) => [p[0] + d[0] * t, p[1] + d[1] * t];
const cross = (a, b) => a[0] * b[1] - a[1] * b[0];
const length = (a) => Math.hypot(a[0], a[1]);
const unit = (a) => [a[0] / length(a), a[1] / length(a)];
const left = (a) => [-a[1], a[0]];
const polar = (radius, angle) => [radius * Math.cos(angle), radius * Math.sin(angle)];
const mix = (a, b, t) => [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];

function area(ring) {
  let twice = 0;
  ring.forEach((p, i) => (twice += cross(p, ring[(i + 1) % ring.length])));
  return twice / 2;
}

function middle(ring) {
  const sum = ring.reduce((a, p) => [a[0] + p[0], a[1] + p[1]], [0, 0]);
  return [sum[0] / ring.length, sum[1] / ring.length];
}

/** What of a convex ring is left of a line through p. */
function leftOf(ring, p, direction) {
  const side = (q) => cross(direction, minus(q, p));
  const result = [];
  ring.forEach((a, i) => {
    const b = ring[(i + 1) % ring.length];
    const [s, t] = [side(a), side(b)];
    if (s >= 0) result.push(a);
    if (s >= 0 !== t >= 0) result.push(mix(a, b, s / (s - t)));
  });
  return result.length < 3 ? [] : result;
}

/** Both sides of a line, with a street of that width between. */
function split(ring, p, direction, street) {
  const aside = left(unit(direction));
  return [
    leftOf(ring, along(p, aside, street / 2), direction),
    leftOf(ring, along(p, aside, -street / 2), [-direction[0], -direction[1]]),
  ].filter((part) => part.length > 2 && area(part) > 350);
}

/** A convex ring that is smaller by that much on every side. */
function inset(ring, distance) {
  let result = ring;
  ring.forEach((a, i) => {
    const direction = unit(minus(ring[(i + 1) % ring.length], a));
    result = leftOf(result, along(a, left(direction), distance), direction);
  });
  return result;
}

function longestSide(ring) {
  let best = [1, 0];
  ring.forEach((a, i) => {
    const side = minus(ring[(i + 1) % ring.length], a);
    if (length(side) > length(best)) best = side;
  });
  return unit(best);
}

function extent(ring, direction) {
  const places = ring.map((p) => p[0] * direction[0] + p[1] * direction[1]);
  return Math.max(...places) - Math.min(...places);
}

/** Blocks with streets between, the narrower the smaller the parts are. */
function blocksOf(ring, largest, street) {
  if (area(ring) < largest * between(0.75, 1.5)) return [ring];
  let axis = longestSide(ring);
  if (extent(ring, axis) < extent(ring, left(axis))) axis = left(axis);
  const turn = between(-0.06, 0.06);
  const across = left(axis);
  const direction = [
    across[0] * Math.cos(turn) - across[1] * Math.sin(turn),
    across[0] * Math.sin(turn) + across[1] * Math.cos(turn),
  ];
  const at = along(middle(ring), axis, extent(ring, axis) * between(-0.08, 0.08));
  return split(ring, at, direction, street).flatMap((part) => blocksOf(part, largest, Math.max(8, street * 0.8)));
}

const riverAt = (y) => [-180 + 210 * Math.sin(y / 700 + 0.4), y];
const riverDirection = (y) => unit(minus(riverAt(y + 1), riverAt(y - 1)));
const fromRiver = (p) => Math.abs(cross(riverDirection(p[1]), minus(p, riverAt(p[1]))));

const coast = [];
for (let i = 0; i < 480; ++i) {
  const angle = (i / 480) * 2 * Math.PI;
  const waves = [
    [2, 0.9, 190],
    [3, 2.1, 130],
    [5, 4.4, 90],
    [9, 1.3, 38],
    [17, 5.2, 22],
    [41, 0.4, 9],
  ];
  const bumps = waves.reduce((sum, [times, phase, size]) => sum + size * Math.sin(times * angle + phase), 0);
  coast.push(polar(2480 + bumps, angle));
}
const coastAt = (p) => coast[Math.round(((Math.atan2(p[1], p[0]) / (2 * Math.PI) + 1) % 1) * 480) % 480];
const isInland = (p, margin) => length(p) < length(coastAt(p)) - margin;

function shore(margin) {
  return coast.map((p) => along(p, unit(p), -margin));
}

const BASINS = [0, 1, 2].map((i) => {
  const corner = polar(1560 - 40 * i, -0.62 + 0.125 * i);
  const out = unit(polar(1, -0.5));
  const side = left(out);
  return [
    along(corner, side, -38),
    along(along(corner, side, -38), out, 1300),
    along(along(corner, side, 38), out, 1300),
    along(corner, side, 38),
  ];
});
const isInBasin = (p, margin) =>
  BASINS.some((ring) => ring.every((a, i) => cross(unit(minus(ring[(i + 1) % 4], a)), minus(p, a)) > -margin));

const PLACES = ["Anchor", "Amber", "Beacon", "Cooper", "Crane", "Dogger", "Ferry", "Fisher", "Glass", "Harbour", "Herring",
  "Heron", "Juniper", "Lantern", "Linden", "Maple", "Mast", "Mill", "North", "Oak", "Orchard", "Plover", "Rope", "Sail",
  "Salt", "Sand", "South", "Tern", "Tide", "Weaver", "West", "Willow"];
const WAYS = ["Street", "Lane", "Row", "Road", "Walk", "Quay"];
const PARKS = ["Garden", "Park", "Green", "Common"];

/** Blocks of the whole city: { ring, kind, use, name, street }. */
function makeBlocks() {
  const old = Array.from({ length: 14 }, (_, i) => polar(OLD_TOWN, (i / 14) * 2 * Math.PI + 0.1));
  const found = blocksOf(old, 3800, 12).map((ring) => ({ ring, kind: "closed", from: 0 }));
  for (const { from, to, sectors, block, kind } of RINGS) {
    for (let i = 0; i < sectors; ++i) {
      const gap = 9;
      const [a, b] = [(i / sectors) * 2 * Math.PI + 0.1, ((i + 1) / sectors) * 2 * Math.PI + 0.1];
      const [first, last] = [a + gap / from, b - gap / from];
      const outer = [a + gap / to, (a + b) / 2, b - gap / to].map((angle) => polar(to, angle));
      const sector = [polar(from, first), ...outer, polar(from, last)];
      for (const ring of blocksOf(sector, block, 18)) found.push({ ring, kind, from });
    }
  }
  const blocks = [];
  for (const { ring, kind, from } of found) {
    const at = middle(ring);
    const parts =
      fromRiver(at) < 250
        ? split(ring, riverAt(at[1]), riverDirection(at[1]), 2 * (RIVER_HALF + QUAY))
        : [ring];
    for (const part of parts) {
      const edge = part.flatMap((p, i) => [0, 0.25, 0.5, 0.75].map((t) => mix(p, part[(i + 1) % part.length], t)));
      if (!edge.every((p) => isInland(p, 130) && !isInBasin(p, 70))) continue;
      blocks.push({ ring: part, kind, from, street: `${pick(PLACES)} ${pick(WAYS)}` });
    }
  }
  let market = blocks[0];
  for (const block of blocks) if (length(middle(block.ring)) < length(middle(market.ring))) market = block;
  for (const block of blocks) {
    const at = middle(block.ring);
    const isHarbour = at[0] > 900 && Math.abs(Math.atan2(at[1], at[0]) + 0.5) < 0.3;
    const isCommon = length(minus(at, [-1150, 640])) < 330; // a large park of many parts
    block.use = isCommon || (block !== market && random() < (block.from === 0 ? 0.03 : 0.075)) ? "park" : "housing";
    if (block.use === "housing" && block.from <= 470 && random() < 0.22) block.use = "shops";
    if (isHarbour && block.from > 900) block.use = "industry";
    if (block === market) block.use = "square";
    if (block.use === "park") block.name = isCommon ? "The Common" : `${pick(PLACES)} ${pick(PARKS)}`;
    if (block.use === "square") block.name = "Market Square";
  }
  return blocks;
}

/** Gardens where the walls of the old town were, between the streets that lead out of it. */
function makeRamparts() {
  const { sectors } = RINGS[0];
  return Array.from({ length: sectors }, (_, i) => {
    const [a, b] = [(i / sectors) * 2 * Math.PI + 0.1, ((i + 1) / sectors) * 2 * Math.PI + 0.1];
    const arc = (radius) => Array.from({ length: 9 }, (_, k) => polar(radius, a + (b - a) * (0.06 + 0.11 * k)));
    return { ring: [...arc(456), ...arc(414).reverse()], use: "park", name: "Ramparts" };
  });
}

function makeBridges() {
  return [-1700, -1030, -440, -130, 150, 440, 1030, 1700].map((y) => {
    const [p, direction] = [riverAt(y), riverDirection(y)];
    const aside = left(direction);
    const corner = (s, t) => along(along(p, aside, s * (RIVER_HALF + 14)), direction, t * 8);
    return { ring: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)].reverse(), use: "bridge" };
  });
}

/** Sheds on both quays of every basin, as far as there is ground. */
function makeSheds() {
  const sheds = [];
  for (const [a, b, c, d] of BASINS) {
    for (const [from, to, sign] of [[a, b, 1], [d, c, -1]]) {
      const direction = unit(minus(to, from));
      const aside = left(direction);
      const out = area([a, b, c, d]) > 0 ? -sign : sign;
      for (let at = 20; at < 900; at += 78) {
        const corner = (x, y) => along(along(from, direction, at + x), aside, out * (14 + y));
        const ring = [corner(0, 0), corner(66, 0), corner(66, 17), corner(0, 17)];
        if (!ring.every((p) => isInland(p, 140) && !isInBasin(p, 8))) continue;
        sheds.push({ ring: area(ring) > 0 ? ring : ring.reverse(), use: "industry", floors: 1 });
      }
    }
  }
  return sheds.map((shed, i) => ({ ...shed, name: `Shed ${i + 1}` }));
}

/** Houses in a row along every side of a block, around a court. */
function closedHouses({ ring, street, use }, houses) {
  const depth = between(11, 14);
  const outer = inset(ring, 1.5);
  const inner = inset(outer, depth);
  if (outer.length !== inner.length || inner.length < 3 || area(inner) < 80) {
    if (outer.length > 2) {
      const hole = area(outer) > 900 && inner.length > 2 && area(inner) > 80 ? inner : undefined;
      houses.push({ ring: outer, hole, use, floors: 3, street, number: 1 });
    }
    return;
  }
  let number = 1;
  outer.forEach((a, i) => {
    const next = (i + 1) % outer.length;
    const [b, c, d] = [outer[next], inner[next], inner[i]];
    const count = Math.max(1, Math.round(length(minus(b, a)) / between(11, 17)));
    for (let k = 0; k < count; ++k) {
      if (count > 2 && k > 0 && k < count - 1 && random() < 0.05) continue; // a gate into the court
      const [s, t] = [k / count, (k + 1) / count];
      houses.push({
        ring: [mix(a, b, s), mix(a, b, t), mix(d, c, t), mix(d, c, s)],
        use,
        floors: Math.round(between(3, 5.4)),
        street,
        number: number++,
      });
    }
  });
}

/** Slabs or houses that stand apart, set back from every side of a block. */
function openHouses({ ring, street, use }, houses, { wide, deep, gap, back, floors }) {
  let number = 1;
  const outer = inset(ring, back);
  outer.forEach((a, i) => {
    const b = outer[(i + 1) % outer.length];
    const direction = unit(minus(b, a));
    const inward = left(direction);
    const room = length(minus(b, a));
    for (let at = deep; at + wide < room; at += wide + between(gap, 2 * gap)) {
      const [w, d] = [wide * between(0.8, 1.1), deep * between(0.85, 1.15)];
      const p = along(along(a, direction, at), inward, between(0, 1.5));
      const house = [p, along(p, direction, w), along(along(p, direction, w), inward, d), along(p, inward, d)];
      if (random() < 0.3) {
        const [q, r] = [along(p, direction, w * 0.55), along(p, inward, d * 1.45)];
        house.splice(3, 1, along(q, inward, d), along(q, inward, d * 1.45), r);
      }
      const isWithin = house.every((q) => outer.every((c, k) => {
        const along_side = unit(minus(outer[(k + 1) % outer.length], c));
        return k === i || cross(along_side, minus(q, c)) > deep * 0.9;
      }));
      if (isWithin) houses.push({ ring: house, use, floors: Math.round(between(...floors)), street, number: number++ });
    }
  });
}

const circle = (at, radius, count) =>
  Array.from({ length: count }, (_, i) => along(at, polar(1, (i / count) * 2 * Math.PI), radius));

/** A cross with an apse, about the place. */
function minster(at, size) {
  const shape = [[-3, -0.6], [-0.7, -0.6], [-0.7, -1.6], [0.7, -1.6], [0.7, -0.6], [1.8, -0.6]];
  for (let i = 0; i <= 8; ++i) {
    const angle = (i / 8) * Math.PI;
    shape.push([1.8 + 0.6 * Math.sin(angle), -0.6 * Math.cos(angle)]);
  }
  shape.push([0.7, 0.6], [0.7, 1.6], [-0.7, 1.6], [-0.7, 0.6], [-3, 0.6]);
  return shape.map(([x, y]) => [at[0] + x * size, at[1] + y * size]);
}

function star(at, outer, inner, points) {
  return Array.from({ length: 2 * points }, (_, i) =>
    along(at, polar(1, (i / (2 * points)) * 2 * Math.PI), i % 2 ? inner : outer));
}

function makeBuildings(blocks) {
  const houses = makeBridges().map((bridge, i) => ({ ...bridge, name: `Bridge ${i + 1}`, floors: 0 }));
  for (const block of blocks) {
    if (block.use === "park") continue;
    if (block.use === "square") {
      houses.push({ ring: minster(middle(block.ring), 8), use: "landmark", name: "Dogger Minster", floors: 9 });
    } else if (block.use === "industry") {
      openHouses(block, houses, { wide: 30, deep: 17, gap: 7, back: 6, floors: [1, 2] });
    } else if (block.kind === "closed") {
      closedHouses(block, houses);
    } else if (block.kind === "open") {
      if (random() < 0.55) closedHouses(block, houses);
      else openHouses(block, houses, { wide: 34, deep: 12, gap: 10, back: 5, floors: [4, 8] });
    } else {
      openHouses(block, houses, { wide: 12, deep: 10, gap: 5, back: 6, floors: [1, 2.4] });
    }
  }
  houses.push(...makeSheds());
  const stadium = along([-1150, 640], [1, 0.2], 60);
  const bowl = { ring: circle(stadium, 105, 64), hole: circle(stadium, 68, 48), name: "Dogger Bowl", floors: 3 };
  const fort = polar(length(coastAt(polar(1, 2.2))) - 90, 2.2);
  const walls = { ring: star(fort, 75, 40, 5), hole: star(fort, 48, 27, 5), name: "Sand Fort", floors: 2 };
  houses.push({ ...bowl, use: "landmark" }, { ...walls, use: "landmark" });
  return houses;
}

function degrees(ring) {
  const north = 180 / (Math.PI * 6378137);
  const east = north / Math.cos((CENTRE[1] * Math.PI) / 180);
  const points = ring.map(([x, y]) => [
    Number((CENTRE[0] + x * east).toFixed(7)),
    Number((CENTRE[1] + y * north).toFixed(7)),
  ]);
  return [...points, points[0]];
}

function feature(properties, ring, ...holes) {
  const rings = [ring, ...holes.map((hole) => [...hole].reverse())];
  return { type: "Feature", properties, geometry: { type: "Polygon", coordinates: rings.map(degrees) } };
}

function landFeatures() {
  const town = coast.map((p) => along([0, 0], unit(p), Math.min(2368, length(p) - 122)));
  return [
    feature({ name: "Beach", kind: "beach" }, coast, shore(45)),
    feature({ name: "Dunes", kind: "dunes" }, shore(45), shore(110)),
    feature({ name: "Meadows", kind: "meadow" }, shore(110), town),
    feature({ name: "Dogger", kind: "town" }, town),
  ];
}

function waterFeatures() {
  const banks = [[], []];
  for (let y = -2900; y <= 2900; y += 20) {
    const p = riverAt(y);
    const aside = left(riverDirection(y));
    const half = RIVER_HALF + 5 * Math.sin(y / 130) + Math.max(0, Math.abs(y) - 1900) / 12;
    if (!isInland(p, -40)) continue;
    banks[0].push(along(p, aside, half));
    banks[1].push(along(p, aside, -half));
  }
  const pond = circle([0, 0], 1, 40).map((p, i) => along([-1210, 480], p, 58 + 12 * Math.sin((i / 40) * 6 * Math.PI)));
  return [
    feature({ name: "Silver River", kind: "river" }, [...banks[1], ...banks[0].reverse()]),
    feature({ name: "Pond of the Common", kind: "pond" }, pond),
    ...BASINS.map((ring, i) => feature({ name: `Basin ${i + 1}`, kind: "harbour" }, ring)),
  ];
}

function features(layer) {
  if (layer === "land") return landFeatures();
  if (layer === "water") return waterFeatures();
  const blocks = makeBlocks();
  if (layer === "blocks") {
    const all = [...makeRamparts(), ...blocks];
    return all.map(({ ring, use, name, street }) => feature({ name: name ?? street, use }, ring));
  }
  if (layer !== "buildings") return undefined;
  return makeBuildings(blocks).map(({ ring, hole, use, floors, name, street, number }) =>
    feature({ name: name ?? `${street} ${number}`, use, floors }, ring, ...(hole ? [hole] : [])));
}

const [layer, target] = process.argv.slice(2);
const made = features(layer);
if (!made || !target) {
  console.error("usage: node make_city.mjs land|blocks|water|buildings FILE");
  process.exit(2);
}
writeFileSync(target, made.map((each) => `${JSON.stringify(each)}\n`).join(""));
