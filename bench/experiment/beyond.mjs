// What the paper leaves for later, at the scales of its Figure 7: the section "Beyond the paper" of
// bench/RESULTS.md, and its pictures. They are maps by WMS of a server that is started for it.
//
//   node beyond.mjs PROGRAM BUILDINGS.fgb BENCH_FOLDER      writes the section of the page that there is
import { spawn } from 'node:child_process'
import { once } from 'node:events'
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { createInterface } from 'node:readline'
import { pathToFileURL } from 'node:url'

import { bytes, count, table } from './figures.mjs'

const HEADING = '## Beyond the paper'
const WIDTH = 320 // pixels
const HEIGHT = 240
const METRES_OF_A_PIXEL = 0.00028 // as on the trip
const EARTH_RADIUS = 6378137
const SCALES = [250_000, 80_000, 50_000, 29_000, 3_000]
const MIDDLE = [114.0592, 22.5409] // degrees: Futian, where houses are dense and of all sizes
const LOOK = 'fill=b0524a&background=faf8f2'

// Name of the picture, heading of the column, layer, and parameters beside LOOK.
const WAYS = [
  ['plain', 'the paper', 'plain', ''],
  ['merge', '`merge=4`', 'blocks', 'merge=4'],
  ['grow', '`grow=2`', 'plain', 'grow=2'],
  ['shape', '`weights = "shape"`, `simplify=2`', 'shape', 'simplify=2'],
  ['distance', 'Douglas-Peucker, `simplify=2`', 'plain', 'simplify=2'],
  ['smooth', '`smooth=8`, `simplify=2`', 'plain', 'simplify=2&smooth=8']
]

function configuration(buildings) {
  const layer = (name, more) => `[[layer]]\nname = "${name}"\nfile = "${buildings}"\n${more}\n`
  return '[server]\naddress = "127.0.0.1"\nport = 0\n' + layer('plain', 'coverage = "off"') +
    layer('blocks', 'merge = 4') + layer('shape', 'coverage = "off"\nweights = "shape"')
}

// A server, when it is ready: {url, stop}.
async function serve(program, buildings) {
  const folder = mkdtempSync(join(tmpdir(), 'trapeze-beyond-'))
  const file = join(folder, 'trapeze.toml')
  writeFileSync(file, configuration(buildings))
  const child = spawn(program, ['serve', '--config', file], { stdio: ['ignore', 'pipe', 'pipe'] })
  const ended = once(child, 'exit').then(([code]) => { throw new Error(`${program} ended with ${code}`) })
  const stop = async () => {
    ended.catch(() => {})
    child.kill()
    await once(child, 'exit')
    rmSync(folder, { recursive: true })
  }
  const said = createInterface({ input: child.stderr })
  child.stdout.resume()
  const listening = (async () => {
    for await (const line of said) {
      const url = /http:\/\/localhost:\d+/.exec(line)?.[0]
      if (url) return url
    }
    throw new Error(`${program} does not listen`)
  })()
  const url = await Promise.race([listening, ended])
  child.stderr.resume()
  while ((await fetch(`${url}/ready`)).status !== 200) await new Promise(wake => setTimeout(wake, 200))
  return { url, stop }
}

// Web Mercator is larger than the ground by the cosine of the latitude.
function box(scale) {
  const [longitude, latitude] = MIDDLE.map(degrees => degrees * Math.PI / 180)
  const pixel = scale * METRES_OF_A_PIXEL / Math.cos(latitude)
  const x = EARTH_RADIUS * longitude
  const y = EARTH_RADIUS * Math.log(Math.tan(Math.PI / 4 + latitude / 2))
  return [x - WIDTH / 2 * pixel, y - HEIGHT / 2 * pixel, x + WIDTH / 2 * pixel, y + HEIGHT / 2 * pixel]
}

async function map(url, layer, parameters, scale) {
  const asked = `${url}/wms?SERVICE=WMS&VERSION=1.3.0&REQUEST=GetMap&LAYERS=${layer}&STYLES=&CRS=EPSG:3857` +
    `&BBOX=${box(scale).join(',')}&WIDTH=${WIDTH}&HEIGHT=${HEIGHT}&FORMAT=image/png&${LOOK}&${parameters}`
  const answer = await fetch(asked)
  if (answer.headers.get('content-type') !== 'image/png') throw new Error(await answer.text())
  return Buffer.from(await answer.arrayBuffer())
}

/**
 * Writes the pictures into the folder `results` and returns the section.
 * @param program path of trapeze
 * @param buildings path of Shenzhen's buildings
 */
export async function beyond(program, buildings, results) {
  const server = await serve(program, buildings)
  try {
    const rows = []
    for (const [i, scale] of SCALES.entries()) {
      const row = [`1:${count(scale)}`]
      for (const [name, , layer, parameters] of WAYS) {
        const file = `beyond-${i + 1}-${name}.png`
        const png = await map(server.url, layer, parameters, scale)
        writeFileSync(join(results, file), png)
        row.push(`![${name}](results/${file}) ${bytes(png.length)}`)
      }
      rows.push(row)
    }
    return `${HEADING}

What the paper shows and leaves for later (its sections 5.2 and 6, Figure 10): conflicts of size and of
proximity, displacement, exaggeration, and shapes that are kept. Shenzhen's buildings at the scales of Figure 7, ${WIDTH} x
${HEIGHT} pixels at ${MIDDLE[0]} E, ${MIDDLE[1]} N, with the bytes of each picture as PNG. The last three are at eight times
the usual tolerance, so that there is something to be seen of what they do.

${table(['scale', ...WAYS.map(([, title]) => title)], rows)}

[Blocks](../docs/coverage.md#blocks), [growth](../docs/styling.md#what-is-narrow),
[smooth corners](../docs/styling.md#smooth-corners) and [weights](../docs/data.md) are described where they are set; what
they keep to, with proofs, in [core/README.md](../core/README.md).
`
  } finally {
    await server.stop()
  }
}

async function main([program, buildings, bench]) {
  const results = join(bench, 'results')
  mkdirSync(results, { recursive: true })
  const page = join(bench, 'RESULTS.md')
  const sections = readFileSync(page, 'utf8').split(/^(?=## )/m)
  const section = `${await beyond(program, buildings, results)}\n`
  const at = sections.findIndex(text => text.startsWith(HEADING))
  if (at >= 0) sections[at] = section
  else sections.splice(sections.findIndex(text => text.startsWith('## What took how long')), 0, section)
  writeFileSync(page, sections.join(''))
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) await main(process.argv.slice(2))
