-- For wrk: requests the targets in a file, each thread from another position on, and prints the results.
--
--   wrk -t2 -c32 -d10s -s tests/load/wrk.lua http://localhost:8080 -- FILE [REPEATS]
--
-- FILE contains a target a line ("/tiles/..."). If REPEATS is 0, every request gets a "background" of its
-- own, so that no tile is in the cache. Prints lines "wrk: KEY VALUE" at the end.
local threads = {}

function setup(thread)
  thread:set("number", #threads)
  table.insert(threads, thread)
end

function init(arguments)
  targets = {}
  for line in io.lines(arguments[1]) do table.insert(targets, line) end
  is_fresh = arguments[2] == "0"
  position = (number * 7919) % #targets
  asked, ok, busy, limited, wrong = 0, 0, 0, 0, 0
  math.randomseed(os.time() * 1000 + number)
end

function request()
  position = position % #targets + 1
  asked = asked + 1
  local target = targets[position]
  if is_fresh then
    target = string.format("%s?background=%06x", target, math.random(0, 0xffffff))
  end
  return wrk.format("GET", target)
end

function response(status, headers, body)
  local has_tag = headers["ETag"] or headers["Etag"] or headers["etag"]
  if status == 200 and has_tag and string.sub(body, 2, 4) == "PNG" then
    ok = ok + 1
  elseif status == 503 and (headers["Retry-After"] or headers["retry-after"]) then
    busy = busy + 1
  elseif status == 429 then
    limited = limited + 1
  else
    wrong = wrong + 1
  end
end

function done(summary, latency, requests)
  local sums = { ok = 0, busy = 0, limited = 0, wrong = 0 }
  for _, thread in ipairs(threads) do
    for key in pairs(sums) do sums[key] = sums[key] + thread:get(key) end
  end
  local seconds = summary.duration / 1e6
  local errors = summary.errors
  for _, key in ipairs({ "ok", "busy", "limited", "wrong" }) do
    print(string.format("wrk: %s %d", key, sums[key]))
  end
  print(string.format("wrk: lost %d", errors.connect + errors.read + errors.write + errors.timeout))
  print(string.format("wrk: answers_a_second %.0f", summary.requests / seconds))
  for _, share in ipairs({ 50, 95, 99 }) do
    print(string.format("wrk: p%d_ms %.2f", share, latency:percentile(share) / 1000))
  end
end
