// How the visible layers are requested together.
import assert from "node:assert/strict";
import test from "node:test";

import { shared_style } from "../../web/share_style.js";
import { tile_requests } from "../../web/tile_requests.js";

const layers = (count, more = {}) => Array.from({ length: count }, (_, i) => ({
  name: `layer${i}`, minzoom: 0, maxzoom: 24, topologies: ["strict"], ...more,
}));
const drawn = (known, style = []) => known.map(({ name }) => ({ name, style: new Map(style) }));
const settings = (known, more = {}) => ({
  layers: known, shared: new Map(), has_background: false, folder: "/tiles/", ...more,
});

test("all layers are one request, each with its own parameters", () => {
  const known = layers(2);
  const [request, ...more] = tile_requests(
    [{ name: "layer0", style: new Map([["fill", "red"]]) }, { name: "layer1", style: new Map() }],
    settings(known, { shared: new Map([["simplify", "4"]]) }));
  assert.deepEqual(more, []);
  assert.equal(request.path, "layer0,layer1");
  assert.equal(request.query, "?layer0.fill=red&simplify=4");
  assert.deepEqual(request.parts.map(({ path, query }) => path + query),
    ["layer0?fill=red&simplify=4", "layer1?simplify=4"]);
});

test("one request has 16 layers at most, and the background of a style lies below the lowest", () => {
  const known = layers(35);
  const requests = tile_requests(drawn(known), settings(known, {
    shared: new Map([["style", "night"]]), has_background: true,
  }));
  assert.deepEqual(requests.map((request) => request.layers.length), [16, 16, 3]);
  assert.deepEqual(requests.flatMap((request) => request.layers), known.map(({ name }) => name));
  assert.deepEqual(requests.map(({ query }) => query.includes("background=0000")),
    [false, true, true]);
  assert.deepEqual(requests[0].parts.map(({ query }) => query.includes("background=0000")),
    [false, ...Array(15).fill(true)]);
});

test("no address is longer than the server takes", () => {
  const known = layers(12);
  const requests = tile_requests(drawn(known, [["filter", "x".repeat(900)]]), settings(known));
  assert.ok(requests.length > 2);
  for (const { path, query } of requests) assert.ok((path + query).length < 4000);
  assert.deepEqual(requests.flatMap((request) => request.layers), known.map(({ name }) => name));
});

test("zooms are those at which any of the layers is drawn", () => {
  const known = [...layers(1, { minzoom: 4, maxzoom: 9 }),
    { ...layers(2)[1], minzoom: 2, maxzoom: 7 }];
  const [{ min_zoom, max_zoom, parts }] = tile_requests(drawn(known), settings(known));
  assert.deepEqual([min_zoom, max_zoom], [2, 9]);
  assert.deepEqual(parts.map((part) => [part.min_zoom, part.max_zoom]), [[4, 9], [2, 7]]);
});

test("topology=fast is asked of those that are served with it", () => {
  const known = [...layers(1, { topologies: ["fast", "strict"] }), layers(2)[1]];
  const [{ query, parts }] = tile_requests(drawn(known),
    settings(known, { shared: new Map([["topology", "fast"]]) }));
  assert.equal(query, "?layer0.topology=fast");
  assert.deepEqual(parts.map((part) => part.query), ["?topology=fast", ""]);
});

test("what a layer has locked is asked only of the others", () => {
  const known = [...layers(1, { locked: ["simplify", "label-language"] }), layers(2)[1]];
  const shared = new Map([["simplify", "4"], ["small", "keep"]]);
  const [{ query, parts }] = tile_requests(drawn(known), settings(known, { shared }));
  assert.equal(query, "?layer1.simplify=4&small=keep");
  assert.deepEqual(parts.map((part) => part.query), ["?small=keep", "?simplify=4&small=keep"]);
});

test("a parameter of a layer and of all is given once, and that of the layer holds", () => {
  const shared = new Map([["simplify", "4"]]);
  const query_of = (known) =>
    tile_requests(drawn(known, [["simplify", "1"]]), settings(known, { shared }))[0].query;
  assert.equal(query_of(layers(1)), "?simplify=1");
  assert.equal(query_of(layers(2)), "?layer0.simplify=1&layer1.simplify=1&simplify=4");
});

test("a parameter of all layers also holds where a named style sets it for one of them", () => {
  const known = layers(2);
  const shared = new Map([["style", "night"], ["simplify", "4"]]);
  const named = { layers: { layer1: { simplify: 8, fill: "red" } } };
  const [{ query }] = tile_requests(drawn(known), settings(known, { shared, named }));
  assert.equal(query, "?layer1.simplify=4&style=night&simplify=4");
  const { styled } = shared_style(drawn(known), settings(known, { shared, named }));
  assert.deepEqual(styled.map(({ style }) => [...style]), [[], [["simplify", "4"]]]);
  const locked = [known[0], { ...known[1], locked: ["simplify"] }];
  assert.equal(tile_requests(drawn(locked), settings(locked, { shared, named }))[0].query,
    "?layer0.simplify=4&style=night");
  // What is posted is not a style of the operator.
  const { document } = shared_style(drawn(locked),
    settings(locked, { shared, named: { ...named, small: "keep" } }));
  assert.deepEqual(document,
    { small: "keep", layers: { layer0: { simplify: "4" }, layer1: { fill: "red" } } });
});

test("no layers are no requests", () => {
  assert.deepEqual(tile_requests([], settings(layers(2))), []);
});

test("a style to keep is the named one with what was changed over it, without what was clicked", () => {
  const known = layers(2);
  const named = {
    background: "000000ff", simplify: 2,
    layers: { layer0: { fill: "112233ff", "color-by": "a", classes: "x:f00", simplify: 3 } },
  };
  const { document } = shared_style(
    [{ name: "layer0", style: new Map([["color-by", "b"], ["breaks", "1,2"], ["ramp", "Reds"]]) },
      { name: "layer1", style: new Map([["highlight", "7"]]) }],
    { layers: known, shared: new Map([["style", "night"], ["simplify", "8"]]), named });
  assert.deepEqual(document, {
    background: "000000ff", simplify: "8",
    layers: { layer0: { fill: "112233ff", "color-by": "b", breaks: "1,2", ramp: "Reds" } },
  });
});

test("what is not changed by hand needs no style to be kept", () => {
  const known = layers(1);
  const style = shared_style([{ name: "layer0", style: new Map([["highlight", "7"]]) }],
    { layers: known, shared: new Map([["style", "night"]]), named: { fill: "red" } });
  assert.equal(style.document, null);
  assert.equal(style.name, "night");
});
