// The tables of quality of one map.
import { count, table } from './figures.mjs'

const titles = {
  dp: 'DP, BLG tree', paper: "The paper's method", trapeze: 'Trapeze', dust: 'Trapeze, with dust'
}

const scalesOf = rows => [...new Set(rows.map(row => row.scale))]

function byScale(rows, methods, cell) {
  const scales = scalesOf(rows)
  const body = []
  for (const topology of ['strict', 'fast']) {
    for (const method of methods) {
      const cells = scales.map(scale => {
        const row = rows.find(r => r.method === method && r.topology === topology && r.scale === scale)
        return row ? cell(row) : ''
      })
      const title = titles[method] + (topology === 'fast' ? ', no topology' : '')
      if (cells.some(text => text !== '')) body.push([title, ...cells])
    }
  }
  return table(['', ...scales.map(scale => `1:${count(scale)}`)], body)
}

const flatPictures = map => map.pictures.flatMap(picture =>
  picture.scales.map(scale => ({ method: picture.method, topology: picture.topology, ...scale })))

function invalidTotal(map, methods, topology) {
  return map.quality.filter(q => methods.includes(q.method) && q.topology === topology)
    .reduce((sum, q) => sum + q.invalid, 0)
}

export function quality(map) {
  if (map.quality.length === 0) return ''
  const vector = ['dp', 'paper', 'trapeze']
  const drawn = ['dp', 'paper', 'trapeze', 'dust']
  const pictures = flatPictures(map)
  return `## Quality: ${map.title}

Of the polygons in the first view of each scale (of Trapeze the features, whole); BLG trees leave the same as
DP. Invalid polygons by GEOS (polygons of more than 2,000 holes by an exact plane sweep; without topology also
those whose edges cross); in brackets how many there are, and how many are too small to be left. Ours with
topology: ${invalidTotal(map, ['paper', 'trapeze'], 'strict')} invalid in all.

${byScale(map.quality, vector, q => `${count(q.invalid)} (${count(q.polygons)}, ${count(q.gone)})`)}

Vertices left:

${byScale(map.quality, vector, q => count(q.vertices))}

Greatest Hausdorff distance between a ring and what is left of it, in tolerances:

${byScale(map.quality, vector, q => (q.hausdorff / q.tolerance).toFixed(2))}

Changes of area, all added up whichever way they go, in percent of all area, those of polygons that have gone
included:

${byScale(map.quality, vector, q => (100 * q.area_error).toFixed(3))}

Pictures against those of full detail, over the pixels that are not empty in both, of two views a scale. Mean
difference in 255ths:

${byScale(pictures, drawn, p => p.mean.toFixed(2))}

Pixels off by more than 64, in percent:

${byScale(pictures, drawn, p => (100 * p.share_over_64).toFixed(3))}

Area drawn, more or less than at full detail, in percent:

${byScale(pictures, drawn, p => (100 * p.area).toFixed(2))}
`
}
