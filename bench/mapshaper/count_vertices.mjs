// Simplifies a coverage with mapshaper and counts the vertices that are left, one on a border that
// two polygons share once.
//
//   node count_vertices.mjs FILE METHOD OUTPUT DISTANCE ...
//
// FILE is GeoJSON on a plane, METHOD "dp" (Douglas-Peucker) or "visvalingam" (by area), DISTANCE is
// as for -simplify interval=, in units of the file. The numbers go to the file OUTPUT in the order
// of the distances, one a line. Shapes that are too small go (no keep-shapes); crossings are repaired.
import { writeFileSync } from "node:fs";

import mapshaper from "mapshaper";

const [file, method, output, ...distances] = process.argv.slice(2);

function positions_of(geometry, positions) {
  const polygons = geometry.type === "Polygon" ? [geometry.coordinates] : geometry.coordinates;
  for (const [x, y] of polygons.flat(2)) positions.add(`${x},${y}`);
}

function count_vertices(geojson) {
  const { features, geometries } = JSON.parse(geojson);
  const positions = new Set();
  for (const geometry of geometries ?? features.map((feature) => feature.geometry)) {
    if (geometry) positions_of(geometry, positions);
  }
  return positions.size;
}

const steps = distances.map((distance, i) =>
  `-simplify ${method} interval=${distance} -o ${i}.json format=geojson`);
const files = await mapshaper.applyCommands(`-i ${file} ${steps.join(" ")}`);
const numbers = distances.map((_, i) => count_vertices(files[`${i}.json`]));
writeFileSync(output, numbers.map((number) => `${number}\n`).join(""));
