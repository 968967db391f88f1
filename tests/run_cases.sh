#!/usr/bin/env bash
# Runs a GoogleTest program and prints, of its cases, those that failed or were skipped, those that
# took a second or more, and the one that ran when the program ended by a signal or the time limit:
#   tests/run_cases.sh NAME PROGRAM [OPTION]...
# GEAR3K_TEST_LIMIT is the limit of the whole program in seconds.  When all cases pass, the file
# green/NAME beside the program has the time of the start (for ./check quick).
set -uo pipefail
# Several programs share the processors: threads that wait leave them to others.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
green=$(dirname "$2")/green/$1
shift
mkdir -p "${green%/*}"
touch "$green.running"
timeout --foreground --kill-after=10 "${GEAR3K_TEST_LIMIT:-1200}" "$@" 2>&1 | awk '
  /^\[ RUN      \]/ { running = 1; text = "" }
  running           { text = text $0 "\n" }
  /^\[       OK \]/ { if ($NF == "ms)" && substr($(NF - 1), 2) + 0 >= 1000) print
                      running = 0; next }
  /^\[  (FAILED |SKIPPED) \]/ && running { printf "%s", text; running = 0; next }
  !running && !/^\[-----/ { print }
  END { if (running) printf "%s... and the program ended within this case\n", text }'
status=$?
if [ $status -eq 0 ]; then mv "$green.running" "$green"; else rm -f "$green" "$green.running"; fi
exit $status
