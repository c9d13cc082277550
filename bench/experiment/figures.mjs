// Numbers as they are read, and Markdown tables of them.

export const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length

export const count = value => Math.round(value).toLocaleString('en-US')

// Three digits that count.
export function ms(value) {
  if (value >= 100) return value.toFixed(0)
  if (value >= 10) return value.toFixed(1)
  if (value >= 0.005) return value.toFixed(2)
  return value > 0 ? '< 0.01' : '0'
}

export function bytes(value) {
  if (value >= 999.5e6) return `${(value / 1e9).toFixed(2)} GB`
  if (value >= 999.5e3) return `${(value / 1e6).toFixed(1)} MB`
  return `${(value / 1e3).toFixed(1)} kB`
}

export const percent = share => `${(100 * share).toFixed(0)} %`

export const ratio = (theirs, ours) => {
  const value = theirs / ours
  return value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toFixed(2)
}

// Of the straight line through the logarithms of points (x, y), by least squares.
export function slope(points) {
  const logs = points.map(([x, y]) => [Math.log(x), Math.log(y)])
  const x = mean(logs.map(p => p[0]))
  const y = mean(logs.map(p => p[1]))
  const sum = f => logs.reduce((total, p) => total + f(p), 0)
  return sum(p => (p[0] - x) * (p[1] - y)) / sum(p => (p[0] - x) ** 2)
}

// The first column is text, the others are numbers unless they look like text.
export function table(head, rows) {
  const isText = column => rows.some(row => /[a-z]{4}/.test(row[column] ?? ''))
  const rule = head.map((_, column) => (column === 0 || isText(column) ? '---' : '---:'))
  return [head, rule, ...rows].map(row => `| ${row.join(' | ')} |`).join('\n')
}
