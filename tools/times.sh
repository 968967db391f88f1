#!/usr/bin/env bash
# Measures what a clean clone, a check and a small change take, as the Markdown table of
# CONTRIBUTING.md:   tools/times.sh [PROCESSORS]
# Clones the last commit into a temporary folder; packages are to be installed, the machine idle.
set -euo pipefail
cd "$(dirname "$0")/.."
processors=${1:-2}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
git clone -q . "$folder/gear3k"
cd "$folder/gear3k"
export CCACHE_DISABLE=1
available=$(nproc)
[ "$processors" -gt "$available" ] && processors=$available

# row WHAT COMMAND...: runs it on so many processors and prints a row of the table.
row() {
  local what=$1 log=$folder/log
  shift
  TIMEFORMAT='%R %U %S'
  { time taskset -c "0-$((processors - 1))" "$@" >"$log" 2>&1; } 2>"$folder/time" || {
    cat "$log" >&2
    return 1
  }
  awk -v what="$what" '{ printf "| %s | %.0f | %.0f |\n", what, $1, $2 + $3 }' "$folder/time"
}
# changed FILE: adds a line to a source.
changed() { echo "// $EPOCHSECONDS" >>"$1"; }

echo "| on $processors processors, $(g++ --version | head -n 1) | wall [s] | CPU [s] |"
echo "|---|---|---|"
row "\`./run\`, clean clone" ./run
rm -rf build
row "\`./check\`, clean clone" ./check
row "\`./check quick\`, nothing changed" ./check quick
changed src/geometry/mesh.cpp
row "\`./check quick\`, a line in \`src/geometry/mesh.cpp\`" ./check quick
changed src/cli/optimize_command.cpp
row "\`./check quick\`, a line in \`src/cli/optimize_command.cpp\`" ./check quick
