// gnuplot scripts with their data in them; each draws an SVG and a PNG.
import { join } from 'node:path'

const colours = {
  dp: '#c0504d', blg: '#e08e3c', cdt: '#b8a13a', all: '#8c3b8a', paper: '#4f81bd', trapeze: '#2e7d4f', dust: '#7cb88f',
  none: '#888888'
}
const stageColours = {
  simplify_ms: '#c0504d', tessellate_ms: '#e0a13c', send_ms: '#8064a2', draw_ms: '#4f81bd',
  read_ms: '#a8bcd8'
}
const stageTitles = {
  simplify_ms: 'simplify', tessellate_ms: 'tessellate', send_ms: 'send', draw_ms: 'draw',
  read_ms: 'read back'
}
const inOrder = Object.keys(colours)

function inBothFormats(folder, name, width, height, script) {
  const font = 'font "DejaVu Sans,11"'
  return `
set terminal svg size ${width},${height} ${font} background "white"
set output "${join(folder, name)}.svg"
${script}
unset output
reset
set terminal pngcairo size ${width},${height} ${font}
set output "${join(folder, name)}.png"
${script}
unset output
`
}

const keyBelow = height => `set key at screen 0.5, screen ${height} center center horizontal samplen 2`

const block = (name, rows) => `$${name} << EOD\n${rows.map(row => row.join(' ')).join('\n')}\nEOD\n`

function viewPanel(map, topology, title, value) {
  const races = map.races.filter(race => race.topology === topology)
  const name = race => `${race.method}_${topology}_${title.replace(/\W/g, '')}`
  const data = races.map(race => block(name(race),
    race.views.draw_ms.map((_, i) => [i + 1, Math.max(value(race.views, i), 0.01)])))
  const lines = races.map(race =>
    `$${name(race)} using 1:2 with lines lw 1.6 lc rgb "${colours[race.method]}" title "${race.title}"`)
  return { data: data.join(''), draw: `set title "${title}"\nplot ${lines.join(', \\\n     ')}` }
}

const beforeDraw = (views, i) => views.simplify_ms[i] + views.tessellate_ms[i] + views.send_ms[i]
const total = (views, i) => beforeDraw(views, i) + views.draw_ms[i] + views.read_ms[i]

// The paper's Figure 8.
export function plotViews(map, folder) {
  const panels = [
    viewPanel(map, 'strict', 'a view, with topology', total),
    viewPanel(map, 'fast', 'a view, without topology', total),
    viewPanel(map, 'strict', 'before drawing, with topology', beforeDraw),
    viewPanel(map, 'fast', 'before drawing, without topology', beforeDraw)]
  const key = [`${keyBelow(0.055)} maxrows 4`, 'unset key', 'unset key', 'unset key']
  const script = `
set multiplot layout 2,2 margins 0.07,0.98,0.18,0.95 spacing 0.07,0.12
set logscale y
set xrange [1:72]
set xlabel "view"
set grid lc rgb "#dddddd"
set format y "%g"
${panels.map((panel, i) => `${key[i]}\n${i % 2 ? 'unset ylabel' : 'set ylabel "ms"'}\n${panel.draw}`).join('\n')}
unset multiplot`
  return panels.map(panel => panel.data).join('') +
    inBothFormats(folder, `views-${map.name}`, 1100, 800, script)
}

// The paper's Figure 9.
export function plotStages(maps, folder) {
  const stages = Object.keys(stageTitles)
  const data = maps.map(map => block(`stages_${map.name}`, map.averages
    .filter(a => a.topology === 'strict' && a.method !== 'all')
    .sort((a, b) => inOrder.indexOf(a.method) - inOrder.indexOf(b.method))
    .map(a => [`"${a.title}"`, ...stages.map(stage => a[stage])])))
  const panels = maps.map((map, i) => `${i > 0 ? 'unset key\nunset ylabel\n' : ''}set title "${map.name}, with topology"
plot ${stages.map((stage, i) => `$stages_${map.name} using ${i + 2}${i === 0 ? ':xtic(1)' : ''} lc rgb "${stageColours[stage]}" title "${stageTitles[stage]}"`).join(', \\\n     ')}`)
  const script = `
set multiplot layout 1,${maps.length} margins 0.06,0.94,0.38,0.93 spacing 0.06,0
set style data histograms
set style histogram rowstacked
set style fill solid 0.9 border lc rgb "white"
set boxwidth 0.75
set yrange [0:*]
set ylabel "ms a view"
set xtics rotate by -50
${keyBelow(0.06)} maxrows 2 maxcols 3
set grid ytics lc rgb "#dddddd"
${panels.join('\n')}
unset multiplot`
  return data.join('') + inBothFormats(folder, 'stages', 1100, 560, script)
}

export function plotGrowth(growth, folder) {
  const columns = ['build_ms', 'weigh_ms', 'generalize_ms', 'undo_ms', 'load_ms', 'view_ms']
  const titles = ['trapezoidation', 'weights', 'generalization', 'undo', 'load with history', 'one view']
  const palette = ['#c0504d', '#e0a13c', '#2e7d4f', '#7cb88f', '#4f81bd', '#8064a2']
  const rows = growth.map(p => [p.vertices, ...columns.map(c => p[c]), p.graph_memory / 1e6,
    p.layer_memory / 1e6])
  const last = growth[growth.length - 1]
  const lines = columns.map((_, i) =>
    `$growth using 1:${i + 2} with linespoints pt 7 ps 0.5 lw 1.6 lc rgb "${palette[i]}" title "${titles[i]}"`)
  const script = `
set multiplot layout 1,2
set logscale xy
set format x "10^{%L}"
set format y "%g"
set xrange [${growth[0].vertices}:${last.vertices}]
set xlabel "vertices"
set grid lc rgb "#dddddd"
set key bottom right
set ylabel "ms"
set title "time"
plot ${lines.join(', \\\n     ')}, \\
     ${last.generalize_ms / last.vertices} * x with lines dt 2 lc rgb "#555555" title "O(n)"
set key top left
set ylabel "MB"
set title "memory"
plot $growth using 1:8 with linespoints pt 7 ps 0.5 lw 1.6 lc rgb "#2e7d4f" title "adaptable graph with its log", \\
     $growth using 1:9 with linespoints pt 7 ps 0.5 lw 1.6 lc rgb "#4f81bd" title "layer with history", \\
     ${last.layer_memory / 1e6 / last.vertices} * x with lines dt 2 lc rgb "#555555" title "O(n)"
unset multiplot`
  return block('growth', rows) + inBothFormats(folder, 'growth', 1100, 480, script)
}
