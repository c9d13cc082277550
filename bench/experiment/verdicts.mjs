// What was aimed at, what was found, and which stage is to blame where it is not reached.
import { count, mean, ms, percent, ratio, table } from './figures.mjs'

const paperGoal = 6
const trapezeGoal = 20
const baselines = ['dp', 'blg']
const beforeStages = ['simplify_ms', 'tessellate_ms', 'send_ms']
const allStages = [...beforeStages, 'draw_ms', 'read_ms']
const stageTitles = {
  paper: { simplify_ms: 'adapting the graphs', send_ms: 'listing and sending trapezoids' },
  trapeze: { simplify_ms: 'selecting' },
  all: {
    simplify_ms: 'simplifying', tessellate_ms: 'tessellating', send_ms: 'sending',
    draw_ms: 'drawing', read_ms: 'reading back'
  }
}
const titleOf = (method, stage) => stageTitles[method]?.[stage] ?? stageTitles.all[stage]

const find = (map, method) => map.averages.find(a => a.method === method && a.topology === 'strict')

const times = value => `${ratio(value, 1)} times`

function judged(theirs, ours, goal) {
  const reached = theirs / ours
  const verdict = reached >= goal ? 'holds' : `${ratio(goal, reached)} times short`
  return `${ratio(theirs, ours)}: ${verdict}`
}

function claimTable(maps) {
  const rows = maps.flatMap(map => baselines.flatMap(name => {
    const theirs = find(map, name)
    const paper = find(map, 'paper')
    const trapeze = find(map, 'trapeze')
    if (!theirs || !paper || !trapeze) return []
    return [[`${map.name}, against ${theirs.title}`,
      judged(theirs.before, paper.before, paperGoal), judged(theirs.total, paper.total, paperGoal),
      judged(theirs.before, trapeze.before, trapezeGoal), judged(theirs.total, trapeze.total, 1)]]
  }))
  return table(['', `paper, before drawing (${paperGoal})`, `paper, total (${paperGoal})`,
    `Trapeze, before drawing (${trapezeGoal})`, 'Trapeze, total (ahead)'], rows)
}

// The stage that takes ours longest, and what would be reached if it took no time.
function blame(theirs, ours, stages) {
  const sum = stages.reduce((total, stage) => total + ours[stage], 0)
  const worst = stages.reduce((a, b) => (ours[b] > ours[a] ? b : a))
  const rest = sum - ours[worst]
  const without = theirs / rest
  return `${titleOf(ours.method, worst)} is to blame, ${ms(ours[worst])} of ${ms(sum)} ms ` +
    `(${percent(ours[worst] / sum)})` +
    (rest > 0.01 * sum ? `; if it took no time, the factor would be ${ratio(without, 1)}` : '')
}

function paperVerdict(theirs, paper) {
  const lines = []
  if (theirs.before < paperGoal * paper.before) {
    lines.push(`The paper's method before drawing: ${blame(theirs.before, paper, beforeStages)}.`)
  }
  if (theirs.total < paperGoal * paper.total) {
    const device = paper.draw_ms + paper.read_ms
    lines.push(`The paper's method in total: ${blame(theirs.total, paper, allStages)}. Drawing and ` +
      `reading back take ${theirs.title} ${ms(theirs.draw_ms + theirs.read_ms)} ms and the paper's ` +
      `method ${ms(device)} ms; if all before them took the latter no time, the factor would be ` +
      `${ratio(theirs.total, device)}.`)
  }
  return lines
}

// By scale: how many times longer theirs takes before drawing.
function factorsByScale(map, theirs, ours) {
  const race = method => map.races.find(r => r.method === method && r.topology === 'strict')
  const before = (views, i) => beforeStages.reduce((sum, stage) => sum + views[stage][i], 0)
  const scales = [...new Set(map.trip.scales)]
  return scales.map(scale => {
    const views = map.trip.scales.flatMap((s, i) => (s === scale ? [i] : []))
    const of = method => mean(views.map(i => before(race(method).views, i)))
    return { scale, factor: of(theirs.method) / of(ours.method) }
  })
}

function trapezeVerdict(map, theirs, trapeze) {
  const lines = []
  const factors = factorsByScale(map, theirs, trapeze).sort((a, b) => a.factor - b.factor)
  const [least, most] = [factors[0], factors[factors.length - 1]]
  const spread = `by scale the factor is ${ratio(least.factor, 1)} (1:${count(least.scale)}) to ` +
    `${ratio(most.factor, 1)} (1:${count(most.scale)}).`
  if (theirs.before < trapezeGoal * trapeze.before) {
    const nanoseconds = 1e6 * trapeze.before / trapeze.trapezoids
    lines.push(`Trapeze before drawing: ${blame(theirs.before, trapeze, beforeStages)}: it takes ` +
      `${ms(nanoseconds)} ns a trapezoid drawn, and would have to take ` +
      `${ms(theirs.before / trapezeGoal)} ms a view; ${spread}`)
  } else {
    lines.push(`Trapeze before drawing: ${spread}`)
  }
  if (theirs.total < trapeze.total) {
    lines.push(`Trapeze in total: ${blame(theirs.total, trapeze, allStages)}. Drawing takes ` +
      `${theirs.title} ${ms(theirs.draw_ms)} ms; in processor time Trapeze is ` +
      `${theirs.cpu >= trapeze.cpu ? 'ahead' : 'behind'}, ${ms(trapeze.cpu)} ms against ${ms(theirs.cpu)}.`)
  }
  return lines
}

// Baselines that look at the view before they simplify are no more those of the paper's measurements.
function cullingVerdict(map) {
  const [whole, culled, paper] = ['all', 'dp', 'paper'].map(method => find(map, method))
  if (!whole || !culled || !paper) return []
  return [`Leaving out what lies beyond the view makes DP ${times(whole.before / culled.before)} as ` +
    `fast before drawing and ${times(whole.total / culled.total)} in total. Without that ` +
    `(*DP, whole map*) the paper's method would be ${times(whole.before / paper.before)} as fast ` +
    `before drawing and ${times(whole.total / paper.total)} in total.`]
}

function mapVerdict(map) {
  const paper = find(map, 'paper')
  const trapeze = find(map, 'trapeze')
  if (!paper || !trapeze) return ''
  const against = baselines.flatMap(name => {
    const theirs = find(map, name)
    if (!theirs) return []
    const lines = [...paperVerdict(theirs, paper), ...trapezeVerdict(map, theirs, trapeze)]
    return lines.map(line => `* Against ${theirs.title}. ${line}`)
  })
  const culling = cullingVerdict(map).map(line => `* ${line}`)
  return [`${map.title}:\n`, ...against, ...culling].join('\n')
}

export function verdicts(maps) {
  return `${claimTable(maps)}

${maps.map(mapVerdict).join('\n\n')}`
}
