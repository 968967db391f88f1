#!/usr/bin/env bash
# Measures what a clean clone, a check and a small change take, as the Markdown table of
# CONTRIBUTING.md:   tools/times.sh [--write] [PROCESSORS]
# Clones the last commit into a temporary folder; packages are to be installed, the machine idle.
# --write puts the table in the place of that in CONTRIBUTING.md, instead of printing it.
set -euo pipefail
cd "$(dirname "$0")/.."
write=
if [ "${1:-}" = --write ]; then
  write=$PWD/CONTRIBUTING.md
  shift
fi
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
# phases NAME...: rows of phases of the last row's ./check, from what it prints at its end.
phases() {
  local name
  for name in "$@"; do
    awk -v name="$name" '$1 == name && $3 == "s" && $5 == "s" {
      printf "| … of it its phase `%s` | %.0f | %.0f |\n", name, $2, $4 }' "$folder/log"
  done
}
# changed FILE: adds a line to a source.
changed() { echo "// $EPOCHSECONDS" >>"$1"; }

[ -z "$write" ] || exec >"$folder/table"
echo "| on $processors processors, $(g++ --version | head -n 1), of $(git rev-parse --short HEAD) | wall [s] | CPU [s] |"
echo "|---|---|---|"
row "\`./run\`, clean clone" ./run
rm -rf build
row "\`./check\`, clean clone" ./check
phases build clang-tidy tests
row "\`./check quick\`, nothing changed" ./check quick
changed src/geometry/mesh.cpp
row "\`./check quick\`, a line in \`src/geometry/mesh.cpp\`" ./check quick
changed src/cli/optimize_command.cpp
row "\`./check quick\`, a line in \`src/cli/optimize_command.cpp\`" ./check quick
if [ -n "$write" ]; then
  awk -v table="$folder/table" '
    /^\| on [0-9]+ processors/ { while ((getline line < table) > 0) print line; old = 1 }
    old && /^\|/ { next }
    { old = 0; print }' "$write" >"$folder/document"
  cat "$folder/document" >"$write"
fi
