# Functions shared by the scripts; source this file. The first comment of a script is its help text. Ctrl-C ends a
# script with a message and status 130; its cleanup at exit (trap ... EXIT) runs then, too.
# shellcheck shell=bash

progress_reporter=

# Called once the foreground command, which received the signal as well, has ended.
end_interrupted() {
  trap '' INT
  [[ -z $progress_reporter ]] || kill "$progress_reporter" 2>/dev/null || true
  printf '%s: interrupted\n' "${0##*/}" >&2
  exit 130
}
trap end_interrupted INT

# Prints the help and exits if the first argument requests it.
help_if_asked() {
  [[ ${1-} == --help || ${1-} == -h ]] || return 0
  sed -n '2,/^[^#]/{/^#/!d;s/^# \{0,1\}//;p}' "$0"
  exit 0
}

# The last line that counts steps, such as ninja's "[3/120] ...", which compiler output may follow; else the last
# line.
last_step() {
  grep -aE '^\[[0-9]+/[0-9]+\]' "$1" 2>/dev/null | tail -n 1 | grep . || tail -n 1 "$1" 2>/dev/null || true
}

# Ends together with the process $3. The builtin read waits, so that no child process is left
# behind.
report_progress() {
  local name=$1 log=$2 of=$3 seconds=0 waiting last
  exec {waiting}<> <(:)
  while ! read -r -t 10 -u "$waiting" && kill -0 "$of" 2>/dev/null; do
    ((seconds += 10))
    last=$(last_step "$log" | tr -cd '[:print:]' | cut -c 1-90)
    printf '%s: %d s; %s (log: %s)\n' "$name" "$seconds" "$last" "$log"
  done
}

# with_progress NAME LOG COMMAND...: writes the command's output to the log and shows its last step every
# ten seconds. Returns the command's status. If the log cannot be written, because another user has built here,
# the script ends, so that nobody takes the log of an earlier run for that of this one.
with_progress() {
  local name=$1 log=$2 status=0
  shift 2
  { : >"$log"; } 2>/dev/null || {
    printf '%s: cannot write %s, which belongs to %s\n' "$name" "$log" \
      "$(stat -c %U "$log" 2>/dev/null || stat -c %U "${log%/*}")" >&2
    printf '%s: run this script as that user, or make all files here yours by chown\n' "$name" >&2
    exit 1
  }
  report_progress "$name" "$log" $$ &
  progress_reporter=$!
  "$@" >"$log" 2>&1 || status=$?
  kill "$progress_reporter" 2>/dev/null || true
  wait "$progress_reporter" 2>/dev/null || true
  progress_reporter=
  return "$status"
}
