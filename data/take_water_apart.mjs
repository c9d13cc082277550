// Writes every polygon of the water package as a feature of its own, one GeoJSON feature a line.
//
//   node take_water_apart.mjs SOURCE.geo.json TARGET.geojsonl
//
// The package is one GeometryCollection of three MultiPolygons without attributes. Their order is
// rivers, lakes, seas; the attribute `kind` keeps that.
import { appendFileSync, closeSync, openSync, readFileSync } from "node:fs";

const KINDS = ["river", "lake", "sea"];
const FEATURES_PER_WRITE = 2000;

function* features(collection) {
  if (collection.type !== "GeometryCollection" || collection.geometries.length !== KINDS.length) {
    throw new Error("expected a GeometryCollection of three MultiPolygons");
  }
  let id = 0;
  for (const [i, geometry] of collection.geometries.entries()) {
    if (geometry.type !== "MultiPolygon") throw new Error(`expected a MultiPolygon at ${i}`);
    for (const coordinates of geometry.coordinates) {
      yield {
        type: "Feature",
        properties: { id: ++id, kind: KINDS[i] },
        geometry: { type: "Polygon", coordinates },
      };
    }
  }
}

const [source, target] = process.argv.slice(2);
const file = openSync(target, "w");
let lines = [];
for (const feature of features(JSON.parse(readFileSync(source, "utf8")))) {
  lines.push(JSON.stringify(feature) + "\n");
  if (lines.length === FEATURES_PER_WRITE) {
    appendFileSync(file, lines.join(""));
    lines = [];
  }
}
appendFileSync(file, lines.join(""));
closeSync(file);
