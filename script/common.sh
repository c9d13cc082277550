# What the scripts share; to be sourced. The first comment of a script is its help.
# shellcheck shell=bash

# Prints the help and ends, if the first argument asks for it.
help_if_asked() {
  [[ ${1-} == --help || ${1-} == -h ]] || return 0
  sed -n '2,/^[^#]/{/^#/!d;s/^# \{0,1\}//;p}' "$0"
  exit 0
}

# Ends with the process of that number. The builtin read waits, so that nothing outlives this.
report_progress() {
  local name=$1 log=$2 of=$3 seconds=0 waiting last
  exec {waiting}<> <(:)
  while ! read -r -t 10 -u "$waiting" && kill -0 "$of" 2>/dev/null; do
    ((seconds += 10))
    last=$(tail -n 1 "$log" 2>/dev/null | tr -cd '[:print:]' | cut -c 1-90)
    printf '%s: %d s; %s (log: %s)\n' "$name" "$seconds" "$last" "$log"
  done
}

# with_progress NAME LOG COMMAND...: what the command says goes to the log; its last line is shown every ten
# seconds. Returns the command's status.
with_progress() {
  local name=$1 log=$2 reporter status=0
  shift 2
  report_progress "$name" "$log" $$ &
  reporter=$!
  "$@" >"$log" 2>&1 || status=$?
  kill "$reporter" 2>/dev/null || true
  wait "$reporter" 2>/dev/null || true
  return "$status"
}
