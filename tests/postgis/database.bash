# Starts a PostgreSQL with PostGIS in a new folder, $work. Sourced by tests and benchmarks; when the sourcing script
# ends, $work is removed and $server is stopped. If a requirement is missing (postgresql-15, postgresql-15-postgis-3,
# curl), the script exits with status 77.

missing() {
  echo "skipped: there is no $1"
  exit 77
}
for bin in /usr/lib/postgresql/*/bin; do :; done # selects the last one
[[ -x $bin/initdb ]] || missing PostgreSQL
compgen -G '/usr/share/postgresql/*/extension/postgis.control' >/dev/null || missing PostGIS
for program in curl setpriv; do
  command -v "$program" >/dev/null || missing "$program"
done

work=$(mktemp -d)
server=
clean_up() {
  [[ -z $server ]] || kill "$server" 2>/dev/null || true
  as_postgres "$bin/pg_ctl" --pgdata "$work/data" --mode immediate stop >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap clean_up EXIT

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  [[ ! -s $work/trapeze.log ]] || tail -20 "$work/trapeze.log" >&2
  exit 1
}

# PostgreSQL refuses to run as root.
as_postgres() {
  if ((EUID == 0)); then
    (cd "$work" && setpriv --reuid=postgres --regid=postgres --clear-groups "$@")
  else
    "$@"
  fi
}

start_database() {
  as_postgres "$bin/pg_ctl" --pgdata "$work/data" --log "$work/data/log" --wait \
    --options "-p $port -c listen_addresses=127.0.0.1 -c unix_socket_directories= -c fsync=off" \
    start >/dev/null
}

start_anywhere() {
  local attempt
  for attempt in 1 2 3 4 5; do
    port=$((20000 + RANDOM % 12000))
    ! start_database || return 0
    echo "attempt $attempt: port $port is taken?"
  done
  fail "PostgreSQL does not start: $(tail -3 "$work/data/log")"
}

# The database "maps" with the schema "atlas"; $connection connects to it, but lacks the password.
make_database() {
  export PGPASSWORD="drop'let 7"
  ((EUID != 0)) || chown postgres "$work"
  chmod 711 "$work"
  (umask 077 && echo "$PGPASSWORD" >"$work/password")
  ((EUID != 0)) || chown postgres "$work/password"
  as_postgres "$bin/initdb" --pgdata "$work/data" --username painter --pwfile "$work/password" \
    --auth scram-sha-256 --encoding UTF8 --locale C >/dev/null
  start_anywhere
  "$bin/createdb" --host 127.0.0.1 --port "$port" --username painter maps
  sql 'CREATE EXTENSION postgis; CREATE SCHEMA atlas;'
  connection="PG:host=127.0.0.1 port=$port user=painter dbname=maps"
}

sql() {
  "$bin/psql" --quiet --no-psqlrc --set ON_ERROR_STOP=1 --host 127.0.0.1 --port "$port" --username painter \
    --dbname maps --tuples-only --no-align --command "$1"
}

# make_parcels BLOCKS: creates the table atlas.parcels, whose changes are recorded in atlas.changes, and the view
# atlas.in_order of it. Blocks of 6 x 4 parcels with streets between them; neighbours share borders, which are not
# straight.
make_parcels() {
  local columns
  columns=$(awk -v blocks="$1" 'BEGIN { print int(sqrt(blocks)) }')
  sql 'CREATE TABLE atlas.parcels (number serial PRIMARY KEY, kind integer, shape geometry(Polygon, 4326));
       CREATE FUNCTION atlas.corner(block integer, x integer, y integer) RETURNS geometry LANGUAGE sql IMMUTABLE AS $$
         SELECT ST_MakePoint(10 + block % '"$columns"' * 0.0028 + 0.0004 * (x / 4.0 + (hashint4(block * 1000 + x * 20 + y) & 255) / 2560.0),
                             45 + block / '"$columns"' * 0.002 + 0.0004 * (y / 4.0 + (hashint4(block * 1000 + x * 20 + y + 500000) & 255) / 2560.0)) $$;
       INSERT INTO atlas.parcels (kind, shape)
       SELECT i % 4, ST_SetSRID(ST_MakePolygon(ST_MakeLine(ARRAY(
           SELECT CASE WHEN k < 4 THEN atlas.corner(block, 4 * x + k, 4 * y)
                       WHEN k < 8 THEN atlas.corner(block, 4 * x + 4, 4 * y + k - 4)
                       WHEN k < 12 THEN atlas.corner(block, 4 * x + 12 - k, 4 * y + 4)
                       ELSE atlas.corner(block, 4 * x, 4 * y + 16 - k) END
           FROM generate_series(0, 16) k ORDER BY k))), 4326)
       FROM (SELECT i, i / 24 AS block, i % 24 % 6 AS x, i % 24 / 6 AS y FROM generate_series(0, '"$((24 * $1 - 1))"') i) AS places;
       CREATE VIEW atlas.in_order AS SELECT * FROM atlas.parcels ORDER BY number;'
  # As docs/operating.md recommends.
  sql 'CREATE TABLE atlas.changes (xid xid8 NOT NULL DEFAULT pg_current_xact_id(), id bigint NOT NULL);
       CREATE INDEX ON atlas.changes (xid);
       CREATE FUNCTION atlas.note_change() RETURNS trigger LANGUAGE plpgsql AS $$
       BEGIN
         IF TG_OP IN ('"'UPDATE', 'DELETE'"') THEN INSERT INTO atlas.changes (id) VALUES (OLD.number); END IF;
         IF TG_OP IN ('"'UPDATE', 'INSERT'"') THEN INSERT INTO atlas.changes (id) VALUES (NEW.number); END IF;
         RETURN NULL;
       END $$;
       CREATE TRIGGER note_change AFTER INSERT OR UPDATE OR DELETE ON atlas.parcels
         FOR EACH ROW EXECUTE FUNCTION atlas.note_change();'
}

# until_true WHAT COMMAND...: waits for half a minute, or for most_tries tenths of a second.
until_true() {
  local what=$1 try
  shift
  for ((try = 0; try < ${most_tries:-300}; ++try)); do
    if "$@"; then return; fi
    kill -0 "$server" 2>/dev/null || fail "the server has ended"
    sleep 0.1
  done
  fail "$what"
}
is_ready() { curl --silent --fail --output /dev/null "$url/ready"; }
port_of_server() { port_told=$(sed -n 's/.*listening on 127.0.0.1 port \([0-9]*\).*/\1/p' "$work/trapeze.log" 2>/dev/null | head -1); [[ -n $port_told ]]; }

# Waits for the server that logs to $work/trapeze.log, and sets $url to its address.
wait_for_server() {
  url=
  until_true "the server does not listen" port_of_server
  url=http://127.0.0.1:$port_told
  until_true "the layers are not read" is_ready
}
