// From the JSON of the experiment to the page bench/RESULTS.md, its plots and pictures, and a summary.
//
//   node write_page.mjs EXPERIMENT.json BENCH_FOLDER PROGRAM
import { execFileSync } from 'node:child_process'
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { basename, dirname, join } from 'node:path'

import { beyond } from './beyond.mjs'
import { plotGrowth, plotStages, plotViews } from './plots.mjs'
import { quality } from './quality_section.mjs'
import { bytes, count, mean, ms, ratio, slope, table } from './figures.mjs'
import { verdicts } from './verdicts.mjs'

const [jsonPath, bench, program] = process.argv.slice(2)
const report = JSON.parse(readFileSync(jsonPath, 'utf8'))
const folder = join(bench, 'results')
rmSync(folder, { recursive: true, force: true })
mkdirSync(folder, { recursive: true })

const topologies = ['strict', 'fast']
const topologyTitle = { strict: 'with topological consistency', fast: 'without topological consistency' }
const stages = ['simplify_ms', 'tessellate_ms', 'send_ms', 'draw_ms', 'read_ms']

// Means over the views of one contestant.
function averages(race) {
  const of = column => mean(race.views[column])
  const stage = Object.fromEntries(stages.map(name => [name, of(name)]))
  const before = stage.simplify_ms + stage.tessellate_ms + stage.send_ms
  return {
    method: race.method, title: race.title, topology: race.topology, ...stage, before,
    total: before + stage.draw_ms + stage.read_ms,
    cpu: of('cpu_ms'), cpuBefore: of('cpu_before_draw_ms'),
    vertices: of('vertices'), trapezoids: of('trapezoids'), bytes: of('bytes'),
    prepare: race.prepare_ms, memory: race.memory, sentBefore: race.sent_before, runs: race.runs,
    seconds: race.seconds
  }
}

for (const map of report.maps) map.averages = map.races.map(averages)
const raced = report.maps.filter(map => map.averages.length > 0)
const inOrder = [...new Map(raced.flatMap(map => map.averages.map(a => [a.method, a.title])))]
const find = (map, method, topology) =>
  map.averages.find(a => a.method === method && a.topology === topology)

function stageTable(map, topology) {
  const rows = map.averages.filter(a => a.topology === topology).map(a => [
    a.title, ms(a.simplify_ms), a.tessellate_ms > 0 ? ms(a.tessellate_ms) : '', ms(a.send_ms),
    ms(a.draw_ms), ms(a.read_ms), `**${ms(a.total)}**`, ms(a.cpu),
    a.vertices > 0 ? count(a.vertices) : '', count(a.trapezoids), bytes(a.bytes)
  ])
  return table(['', 'simplify', 'tessellate', 'send', 'draw', 'read back', 'total',
    'processor time', 'vertices', 'trapezoids', 'sent'], rows)
}

// The paper's Figure 9: of each view the shares, then their mean, as the paper does it.
function shareTable(map) {
  const shares = race => stages.map(stage => mean(race.views[stage].map((value, i) =>
    value / stages.reduce((sum, name) => sum + race.views[name][i], 0))))
  const rows = map.races.filter(race => race.topology === 'strict')
    .map(race => [race.title, ...shares(race).map(share => (100 * share).toFixed(1))])
  return table(['', 'simplify', 'tessellate', 'send', 'draw', 'read back'], rows)
}

function preparationTable(map) {
  const rows = map.averages.filter(a => a.topology === 'strict').map(a => [
    a.title, a.prepare >= 1 ? `${count(a.prepare)} ms` : 'none', bytes(a.memory),
    a.sentBefore > 0 ? bytes(a.sentBefore) : 'nothing'])
  return table(['', 'preparation', 'memory when ready', 'sent before the first view'], rows)
}

function ratioTable() {
  const rows = []
  for (const map of raced) {
    for (const topology of topologies) {
      for (const method of ['paper', 'trapeze', 'dust']) {
        const ours = find(map, method, topology)
        if (!ours) continue
        const cells = ['dp', 'blg'].flatMap(name => {
          const theirs = find(map, name, topology)
          return [ratio(theirs.before, ours.before), ratio(theirs.total, ours.total),
            ratio(theirs.cpu, ours.cpu)]
        })
        rows.push([map.name, topology === 'strict' ? 'yes' : 'no', ours.title, ...cells])
      }
    }
  }
  return table(['map', 'topology', '', 'DP: before drawing', 'DP: total', 'DP: processor time',
    'BLG: before drawing', 'BLG: total', 'BLG: processor time'], rows)
}

function dataTable() {
  const rows = report.maps.flatMap(map => map.layers.map(layer => [
    map.name, `${layer.title} (\`${basename(layer.file)}\`)${layer.below ? `, moved below ${layer.below}` : ''}`,
    layer.origin, map.licence, count(layer.polygons), count(layer.vertices)]))
  return table(['map', 'layer', 'from', 'licence', 'polygons', 'vertices'], rows)
}

function mapSection(map) {
  const share = map.trip.tolerances
  return `### ${map.title}

1:${count(map.smallest_scale)} to 1:${count(map.largest_scale)} and back. The tolerance is ${Math.min(...share).toFixed(2)} to ${Math.max(...share).toFixed(2)} pixels, the level of the
ladder next to ${report.simplify_pixels}. ${runsOf(map)} A view of nothing takes ${ms(map.empty_view.draw_ms + map.empty_view.read_ms)} ms: clearing and reading back.

Means over the 72 views, in milliseconds a view, with topological consistency:

${stageTable(map, 'strict')}

and without:

${stageTable(map, 'fast')}

Shares of the stages in a view, in percent, with topological consistency (of the paper's method and
Trapeze, simplifying is tessellating):

${shareTable(map)}

What comes before the first view:

${preparationTable(map)}

![Milliseconds a view](results/views-${map.name}.svg)
`
}

// Those for reference have one.
function runsOf(map) {
  const most = topology => Math.max(...map.averages.filter(a => a.topology === topology).map(a => a.runs))
  return `Runs: ${most('strict')} with topological consistency, ${most('fast')} without.`
}

function secondsSection() {
  const rows = report.maps.map(map => [map.name, ...['load', 'races', 'quality', 'figures']
    .map(part => map.seconds[part].toFixed(0))])
  const contestants = raced.map(map => [map.name, ...inOrder.map(([method]) => {
    const races = map.averages.filter(a => a.method === method)
    return races.length > 0 ? races.reduce((sum, a) => sum + a.seconds, 0).toFixed(0) : ''
  })])
  return `## What took how long

Seconds: of each map to load it, to prepare the contestants and to run, to measure quality, and to draw the
pictures. Growth took ${report.growth_seconds.toFixed(0)}.

${table(['', 'load', 'race', 'quality', 'pictures'], rows)}

The runs of each contestant, with and without topology together:

${table(['', ...inOrder.map(([, title]) => title)], contestants)}
`
}

function growthSection() {
  if (report.growth.length === 0) return ''
  const points = report.growth
  const series = [['build_ms', 'trapezoidation'], ['weigh_ms', 'weights'],
    ['generalize_ms', 'generalization'], ['undo_ms', 'undo'], ['load_ms', 'load with history'],
    ['view_ms', 'one view'], ['graph_memory', 'memory of the adaptable graph'],
    ['layer_memory', 'memory of the layer']]
  const rows = points.map(p => [count(p.vertices), ...series.map(([name]) =>
    name.endsWith('memory') ? bytes(p[name]) : ms(p[name]))])
  const slopes = ['**slope**', ...series.map(([name]) =>
    `**${slope(points.map(p => [p.vertices, p[name]])).toFixed(2)}**`)]
  const generalize = slope(points.map(p => [p.vertices, p.generalize_ms]))
  const large = points.filter(p => p.vertices >= 1e5)
  const generalizeLarge = large.length > 1 ? slope(large.map(p => [p.vertices, p.generalize_ms])) : NaN
  return `## Growth

One polygon, a coast with bays of all sizes (\`wiggly_star\` in [polygon_families.h](core/polygon_families.h)). Milliseconds.
*Generalization* makes all removals down to the last triangle, *undo* takes all of them back; *load*
is everything from rings to a layer with all versions; *one view* selects and draws the whole polygon
on 1600 x 1200 pixels.

${table(['vertices', ...series.map(([, title]) => title)], [...rows, slopes])}

The slope is that of the straight line through the logarithms: 1 is linear. The paper claims O(n) for
generalization; measured is n^${generalize.toFixed(2)}${Number.isNaN(generalizeLarge) ? '' : ` (from 10^5 vertices on n^${generalizeLarge.toFixed(2)}, where the caches are left behind)`}. Trapezoidation and weights sort, so they
are O(n log n).

![Growth](results/growth.svg)
`
}

function figureSection() {
  const map = report.maps.find(m => m.figures.length > 0)
  if (!map) return ''
  for (const name of map.figures) copyFileSync(join(dirname(jsonPath), name), join(folder, name))
  const shares = [1, 80 / 250, 50 / 250, 29 / 250, 3 / 250]
  const rows = shares.map((share, i) => [`1:${count(share * map.smallest_scale)}`,
    `![map](results/${map.name}-${i + 1}.png)`, `![mesh](results/${map.name}-${i + 1}-mesh.png)`])
  return `## Maps and meshes (the paper's Figure 7)

${map.title}: the middle of the view, 640 x 480 pixels.

${table(['scale', 'map', 'adapted trapezoids'], rows)}
`
}

function page() {
  return `# The paper's experiment

Sections 4 and 5.1 of *An Efficient Visualization Method for Polygonal Data with Dynamic
Simplification*, repeated, and carried on. This page is written by \`script/bench experiment\`, which
repeats all of it; this run took ${(report.seconds / 60).toFixed(0)} minutes.

Machine: ${report.machine}. Drawing: ${report.device}.
Commit: ${report.commit}. Seed of the trip: ${report.seed}.

## Data

${dataTable()}

The paper's own extract (42,334 polygons of buildings, nature and land use around Shenzhen) is not
published. Here Shenzhen's buildings have Melbourne's natural and land-use areas beside them: moved
below, without change of scale. The first two maps are read from the folder that \`TRAPEZE_DATA\` names;
the sample world comes with \`script/bootstrap data\`. Its outlines are exact to about a kilometre, so its
scales are 400 times smaller than the paper's.

To repeat the experiment on any extract of OpenStreetMap, or any other files of polygons:

    trapeze bench experiment city.osm.pbf
    trapeze bench experiment landuse.fgb natural.fgb buildings.fgb --scale 250000

## Contestants

| | a view |
|---|---|
| DP | Douglas-Peucker, topology by the method of Corcoran, Mooney and Winstanley (2011), trapezoidation by open trapezoids (Zalik and others 2003), all trapezoids sent, drawn |
| BLG tree | the same with BLG trees (van Oosterom 1989), built once and asked for every view |
| BLG tree, CDT | the same with CGAL's constrained Delaunay triangulation in place of trapezoids; triangles are drawn as two trapezoids. One run, for reference |
| DP, whole map | DP that leaves nothing out because it lies beyond the view; for maps of up to a million vertices. One run, for reference |
| The paper's method | one trapezoidal graph a polygon, adapted in place, forward and undo; vertices sent once, a view sends vertex numbers (24 bytes a trapezoid), which the device looks up |
| Trapeze | all versions of all trapezoids with their lifespans sent once; a view selects ranges of those alive. Polygons too small for the tolerance are left out, as the others do it |
| Trapeze, with dust | the same as it is served by default: what is too small is kept as covered area |
| No simplification | full detail, sent once, the visible ranges drawn. One run, for reference |

All start from the same polygons: snapped to the grid, noded, taken apart into single polygons. All
use the same weights (Douglas-Peucker), the same tolerance, and draw through the same \`GlRenderer\`:
exact covered area of every pixel, one mask a layer, all layers in one pass. Each contestant computes
on one thread; the device draws on as many as it likes, the same for all.

The baselines are written to win. They leave out polygons beyond the view; keep all memory between
views; simplify straight into the arrays that are tessellated; sweep only the rows of the view, without
building links; drop trapezoids beyond the view before they are sent; write straight into device memory
that stays mapped to the same buffer. The topology method tests the kept vertices in the bounding region
of a chain, found in a grid; what cannot lie inside by its distance is not tested. Before edges that cross are
noded, and before polygons are triangulated, vertices in a row that lie on one side of the view are cut short;
without topology this is most of the work there is to save. The paper's graphs look
at a polygon only if the top of its priority stack says that the tolerance changes it, and list its
trapezoids only then, and leave out trapezoids beyond the view too. Its removals are found before the first view; each run begins at full detail.

## Trip

72 consecutive views of 1600 x 1200 pixels: nine scales inwards and nine back, with three pans at each.
A pixel is 0.28 mm (OGC), and the scale is true at the latitude of the map's middle. Where the view goes
is up to the seed, always to a vertex in view. Contestants take turns run by run; each view counts with
the run of its median total, of two the faster. There are ${report.runs} runs at most, and as many for all: one that would
take those of a map to more than ${count(report.seconds_of_runs)} seconds is not begun. *Processor time* is that of all threads, the device's among them: what
other programs on the machine disturb least. *Read back* adds up along rows what
drawing left, and turns it into 8 bits in memory.

## Results

How many times longer DP and BLG trees take than the methods that adapt; *before drawing* is simplifying,
tessellating and sending:

${ratioTable()}

What was aimed at, with topology: the paper's method at least 6 times as fast as DP and BLG trees, as the
paper claims for a view; Trapeze at least 20 times before drawing, and ahead in total. What was found, and
which stage is to blame where it is less:

${verdicts(raced)}

${raced.length > 0 ? '![Stages](results/stages.svg)\n' : ''}
${raced.map(mapSection).join('\n')}
${report.maps.map(quality).join('\n')}
${growthSection()}
${figureSection()}
${beyondSection}
${secondsSection()}`
}

function summary() {
  const { maps, ...rest } = report
  return {
    ...rest,
    maps: maps.map(({ races, trip, figures, averages: means, ...map }) => ({ ...map, means }))
  }
}

const buildings = report.maps.flatMap(map => map.layers)
  .find(layer => basename(layer.file) === 'shenzhen_buildings.fgb')
const beyondSection = buildings ? await beyond(program, buildings.file, folder) : ''
const gnuplot = script => execFileSync('gnuplot', { input: script, stdio: ['pipe', 'inherit', 'inherit'] })
for (const map of raced) gnuplot(plotViews(map, folder))
if (raced.length > 0) gnuplot(plotStages(raced, folder))
if (report.growth.length > 0) gnuplot(plotGrowth(report.growth, folder))
writeFileSync(join(bench, 'RESULTS.md'), page().replace(/\n{3,}/g, '\n\n').trimEnd() + '\n')
writeFileSync(join(folder, 'summary.json'), JSON.stringify(summary(), portable, 1) + '\n')

// Where the files lie is of this machine only.
function portable(key, value) {
  if (key === 'file') return basename(value)
  return typeof value === 'number' && !Number.isInteger(value) ? Number(value.toPrecision(4)) : value
}
