# shellcheck shell=bash
# Sourced by ./check: phases, each with the time it took.

phase_table=""
phase_failed=""

# phase NAME COMMAND...: runs the command; ends the script when it fails.
phase() {
  local name=$1 begin=$EPOCHREALTIME cpu status=0
  shift
  echo "== $name"
  cpu=$(cpu_ticks)
  "$@" || status=$?
  cpu=$(($(cpu_ticks) - cpu))
  phase_table+=$(awk -v name="$name" -v wall="$(seconds_since "$begin")" -v ticks="$cpu" \
    -v hertz="$(getconf CLK_TCK)" 'BEGIN { printf "%-12s %7.1f s  %7.1f s", name, wall, ticks / hertz }')$'\n'
  [ "$status" -eq 0 ] && return 0
  phase_failed=$name
  exit "$status"
}

# Seconds since $1, a value of EPOCHREALTIME (whose decimal sign follows the locale).
seconds_since() { awk -v a="${1/,/.}" -v b="${EPOCHREALTIME/,/.}" 'BEGIN { print b - a }'; }

# Processor time of all commands that have ended, in ticks.
cpu_ticks() {
  local fields
  read -ra fields <"/proc/$$/stat"
  echo $((fields[15] + fields[16]))
}

# The table of times, for `trap ... EXIT`.
phase_summary() {
  [ -z "$phase_table" ] && return 0
  echo
  printf '%-12s %9s  %9s\n' phase wall CPU
  printf '%s' "$phase_table"
  awk -v wall="$(seconds_since "$phase_begin")" 'BEGIN { printf "%-12s %7.1f s\n", "all", wall }'
  if [ -n "$phase_failed" ]; then echo "FAILED in: $phase_failed"; else echo "passed"; fi
}
phase_begin=$EPOCHREALTIME
