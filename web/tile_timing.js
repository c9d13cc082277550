// Tile latencies, as measured by the browser and as reported by the server.

const LATEST = 60;

/** Calls `tell` with a summary line whenever tiles have loaded; `tiles` is the prefix of their addresses. */
export function watch_tiles(tiles, tell) {
  const latest = [];
  const observer = new PerformanceObserver((list) => {
    const come = list.getEntries().filter((entry) =>
      entry.name.startsWith(tiles) && entry.initiatorType === "img" && entry.responseEnd > 0);
    if (come.length === 0) return;
    latest.push(...come.map(summary_of));
    latest.splice(0, latest.length - LATEST);
    tell(line_of(latest));
    performance.clearResourceTimings(); // otherwise nothing is measured after the first 250
  });
  observer.observe({ type: "resource", buffered: true });
}

/** A tile from the server's cache has no drawing times. */
function summary_of(entry) {
  const steps = entry.serverTiming.map(({ duration }) => duration);
  const is_drawn = steps.length > 0 && entry.transferSize > 0;
  return {
    // Excludes the wait before the request: the browser requests six tiles at a time.
    total: entry.responseEnd - (entry.requestStart || entry.startTime),
    drawing: is_drawn ? steps.reduce((sum, step) => sum + step) : null,
  };
}

function line_of(tiles) {
  const drawn = tiles.filter(({ drawing }) => drawing !== null);
  const parts = [`median ${in_ms(median(tiles.map(({ total }) => total)))}`];
  if (drawn.length) parts.push(`drawing ${in_ms(median(drawn.map(({ drawing }) => drawing)))}`);
  parts.push(`${tiles.length - drawn.length} of ${tiles.length} from a cache`);
  return parts.join(", ");
}

function median(numbers) {
  const sorted = [...numbers].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

function in_ms(ms) {
  return `${ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms`;
}
