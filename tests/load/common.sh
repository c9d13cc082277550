# shellcheck shell=bash disable=SC2034 # its variables are for the scripts that source it
# Functions shared by the load tests: tiles around a place, requests with curl, and checks of the
# answers. Source this file.

# Variables that all of them accept.
base=${TRAPEZE_URL:-http://localhost:8080}
layers=${LAYERS:-countries,water}
lon=${LON:-8.2}
lat=${LAT:-46.8}
zooms=${ZOOMS:-2 3 4 5 6 7 8 9 10}
parallel=${PARALLEL:-8}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}

# tiles ZOOM RADIUS: the "z/x/y" of the square of tiles around the place, row by row, within the world.
tiles() {
  awk -v z="$1" -v r="$2" -v lon="$lon" -v lat="$lat" 'BEGIN {
    pi = atan2(0, -1); n = 2 ^ z; phi = lat * pi / 180
    x = int((lon + 180) / 360 * n)
    y = int((1 - log(sin(phi) / cos(phi) + 1 / cos(phi)) / pi) / 2 * n)
    for (j = y - r; j <= y + r; ++j)
      for (i = x - r; i <= x + r; ++i)
        if (i >= 0 && j >= 0 && i < n && j < n) printf "%d/%d/%d\n", z, i, j
  }'
}

# trip: the tiles of a map of 5 x 5 tiles that zooms in on the place, every tile once.
trip() {
  local zoom
  for zoom in $zooms; do tiles "$zoom" 2; done
}

# ask NAME: requests the URLs on standard input, PARALLEL at a time, over persistent connections;
# writes one line for each answer to $work/NAME: code, seconds, bytes, content type, ETag,
# Retry-After, URL.
ask() {
  awk '{ printf "url = \"%s\"\noutput = \"/dev/null\"\n", $0 }' >"$work/$1.curl"
  local begin end
  begin=$(date +%s.%N)
  curl --silent --no-progress-meter --globoff --parallel --parallel-immediate --parallel-max "$parallel" \
    --connect-timeout 5 --max-time 60 \
    --write-out '%{http_code}\t%{time_total}\t%{size_download}\t%{content_type}\t%header{etag}\t%header{retry-after}\t%{url}\n' \
    --config "$work/$1.curl" >"$work/$1" || true # failures show in the codes: 000 is no answer
  end=$(date +%s.%N)
  echo "$begin $end" >"$work/$1.time"
}

# report NAME: prints rate, codes and percentiles.
report() {
  sort -t $'\t' -k2,2g "$work/$1" | awk -F '\t' -v name="$1" -v clock="$(cat "$work/$1.time")" '
    { ++codes[$1]; bytes += $3; seconds[++n] = $2 }
    function at(share,  i) { i = int(share * n + 0.999999); return 1000 * seconds[i < 1 ? 1 : i] }
    END {
      if (n == 0) { print name ": no answers"; exit }
      split(clock, t, " ")
      printf "%s: %d answers in %.2f s, %.0f a second, %.1f MB;", name, n, t[2] - t[1], n / (t[2] - t[1]), bytes / 1e6
      for (code in codes) printf " %s x %d", code, codes[code]
      printf "\n  p50 %.1f ms, p95 %.1f ms, p99 %.1f ms, longest %.1f ms\n", at(0.5), at(0.95), at(0.99), 1000 * seconds[n]
    }'
}

# judge NAME COUNT [busy]: fails unless there are COUNT answers, all of them pictures, with one ETag
# and one size for each URL. With "busy", 503 with Retry-After is accepted as well.
judge() {
  awk -F '\t' -v count="$2" -v busy="${3-}" '
    function wrong(what) { if (++wrongs <= 5) print "wrong: " what ": " $0 }
    $1 == 503 && busy == "busy" { if ($6 == "") wrong("no Retry-After"); next }
    $1 != 200 { wrong("code"); next }
    $4 != "image/png" || $3 < 60 { wrong("no picture"); next }
    $5 == "" { wrong("no ETag"); next }
    $7 in tag { if (tag[$7] != $5 || size[$7] != $3) wrong("two pictures of one URL"); next }
    { tag[$7] = $5; size[$7] = $3 }
    END {
      if (NR != count) { ++wrongs; printf "wrong: %d answers to %d requests\n", NR, count }
      exit wrongs > 0
    }' "$work/$1" || fail "$1: wrong answers"
  [[ -z ${KNOWN-} ]] || remember "$1"
}

# remember NAME: adds "URL ETag bytes" of all pictures to the file KNOWN; fails if a URL now has two.
remember() {
  awk -F '\t' '$1 == 200 { print $7, $5, $3 }' "$work/$1" | sort -u - "$KNOWN" >"$work/known"
  cut -d ' ' -f 1 "$work/known" | uniq -d >"$work/changed"
  [[ ! -s $work/changed ]] || fail "another picture than before: $(head -3 "$work/changed")"
  cp "$work/known" "$KNOWN"
}

# metric NAME: the value of a metric without labels.
metric() {
  curl --silent --fail --max-time 10 "$base/metrics" | awk -v name="$1" '$1 == name { print $2 }'
}
