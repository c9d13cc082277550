// The address of the viewer: what is written is read back, and nothing mistyped is an error.
import assert from "node:assert/strict";
import test from "node:test";

import { format_hash, parse_hash } from "../../web/place_hash.js";

test("what is written is read back", () => {
  const view = {
    place: { zoom: 12, lat: 35.8992, lon: 14.5146 },
    on: ["a,b", "c/d&e=f", "ünïcode"],
    styles: new Map([["a,b", { fill: "ff8800", opacity: 0.5 }]]),
  };
  const back = parse_hash(format_hash(view));
  assert.deepEqual(back.on, view.on);
  assert.deepEqual(back.styles, view.styles);
  assert.equal(back.place.zoom, 12);
  assert.ok(Math.abs(back.place.lat - view.place.lat) < 1e-4);
});

test("a place is written to less than a pixel at every zoom", () => {
  for (let zoom = 0; zoom <= 22; zoom++) {
    const place = { zoom, lat: -33.123456789012, lon: 151.987654321098 };
    const back = parse_hash(format_hash({ place, on: null, styles: new Map() })).place;
    const pixel = 360 / 2 ** (zoom + 8);
    assert.equal(back.zoom, zoom);
    assert.ok(Math.abs(back.lat - place.lat) < pixel / 2, `latitude at zoom ${zoom}`);
    assert.ok(Math.abs(back.lon - place.lon) < pixel / 2, `longitude at zoom ${zoom}`);
  }
});

test("all layers switched off is not the same as nothing said", () => {
  const off = format_hash({ place: { zoom: 1, lat: 0, lon: 0 }, on: [], styles: new Map() });
  assert.deepEqual(parse_hash(off).on, []);
  assert.equal(parse_hash("#1/0/0").on, null);
});

test("a place that is none is left out", () => {
  const wrong = ["", "#", "#1/2", "#1/2/3/4", "#a/b/c", "#-1/0/0", "#25/0/0", "#3/86/0", "#3//0",
    "#NaN/0/0", "#3/Infinity/0"];
  for (const hash of wrong) assert.equal(parse_hash(hash).place, null, hash);
});

test("a style that is none is left out and the rest is kept", () => {
  const wrong = ["style=a", "style=a,red,1", "style=a,ff0000,2", "style=a,ff0000,", "style=,ff0000,1",
    "style=%,ff0000,1", "style=a,ff0000,-1", "x=y", "="];
  for (const part of wrong) {
    const view = parse_hash(`#1/2/3&${part}&on=b`);
    assert.equal(view.styles.size, 0, part);
    assert.deepEqual(view.on, ["b"], part);
  }
});
