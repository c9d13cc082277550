// The address of the viewer: it can be written and read back, and a mistyped one causes no error.
import assert from "node:assert/strict";
import test from "node:test";

import { format_hash, parse_hash } from "../../web/place_hash.js";

const view_of = (view) => ({
  place: null, on: null, styles: new Map(), shared: new Map(), compare: null, order: null, at: null,
  chosen: null, ...view,
});

test("what is written is read back", () => {
  const view = view_of({
    place: { zoom: 12, lat: 35.8992, lon: 14.5146 },
    on: ["a,b", "c/d&e=f", "ünïcode"],
    styles: new Map([
      ["a,b", new Map([["fill", "ff8800"], ["classes", "'x:y&z#':red,*:eee"]])],
      ["dots.in.it", new Map([["filter", "name = '100 % + 1'"]])],
    ]),
    shared: new Map([["style", "night-2"], ["simplify", "4"], ["debug", "faces,junctions,mesh,tile"],
      ["topology", "fast"], ["small", "drop"]]),
    compare: 0.25,
    order: ["c/d&e=f", "a,b"],
    at: { lat: -12.3456789, lon: 179.5 },
    chosen: { layer: "c/d&e=f", id: "-12345678901234567" },
  });
  const back = parse_hash(format_hash(view));
  assert.ok(Math.abs(back.place.lat - view.place.lat) < 1e-4);
  assert.deepEqual({ ...back, place: null }, { ...view, place: null });
  assert.equal(back.place.zoom, 12);
});

test("what is compared with is written where anything is", () => {
  const view = view_of({ place: { zoom: 1, lat: 0, lon: 0 }, compare: 0.5, against: "apart" });
  assert.ok(format_hash(view).endsWith("&compare=0.5&against=apart"));
  assert.deepEqual(parse_hash(format_hash(view)), view);
  assert.ok(!format_hash({ ...view, compare: null }).includes("against"));
});

test("a place is written to less than a pixel at every zoom", () => {
  for (let zoom = 0; zoom <= 22; zoom++) {
    const place = { zoom, lat: -33.123456789012, lon: 151.987654321098 };
    const back = parse_hash(format_hash(view_of({ place }))).place;
    const pixel = 360 / 2 ** (zoom + 8);
    assert.equal(back.zoom, zoom);
    assert.ok(Math.abs(back.lat - place.lat) < pixel / 2, `latitude at zoom ${zoom}`);
    assert.ok(Math.abs(back.lon - place.lon) < pixel / 2, `longitude at zoom ${zoom}`);
  }
});

test("no debug marks at all are kept, because a named style may have some", () => {
  const view = view_of({ place: { zoom: 1, lat: 0, lon: 0 }, shared: new Map([["style", "mesh"], ["debug", ""]]) });
  assert.deepEqual(parse_hash(format_hash(view)), view);
});

test("all layers switched off is not the same as nothing said", () => {
  const off = format_hash(view_of({ place: { zoom: 1, lat: 0, lon: 0 }, on: [] }));
  assert.deepEqual(parse_hash(off).on, []);
  assert.equal(parse_hash("#1/0/0").on, null);
});

test("a place that is none is left out", () => {
  const wrong = ["", "#", "#1/2", "#1/2/3/4", "#a/b/c", "#-1/0/0", "#25/0/0", "#3/86/0", "#3//0",
    "#NaN/0/0", "#3/Infinity/0"];
  for (const hash of wrong) assert.equal(parse_hash(hash).place, null, hash);
});

test("a part that is none is left out and the rest is kept", () => {
  const wrong = ["fill=red", "a.fill=", "a.fill", ".fill=red", "%.fill=red", "a.=red", "a.Fill=red",
    "a.b<c=1", "a.fill=%", "x=y", "=", "simplify=", "simplify=-1", "simplify=65", "simplify=x",
    "topology=loose", "style=a.b", "style=", "small=", "debug=mesh,all", "compare=1.5",
    "compare=", "against=", "against=all", "at=1", "at=1,2,3",
    "at=86,0", "at=0,181", "at=,", "toString=1", "__proto__=1"];
  for (const part of wrong) {
    assert.deepEqual(parse_hash(`#1/2/3&${part}&on=b`),
      view_of({ place: { zoom: 1, lat: 2, lon: 3 }, on: ["b"] }), part);
  }
});
