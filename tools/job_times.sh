#!/usr/bin/env bash
# What the three jobs of examples/jobs take, and the first in larger envelopes:
#   tools/job_times.sh [PROGRAM]      (gear3k unless stated; some three minutes)
# Processor seconds of one thread, of the best design with its proof and of all tooth sets; two cores take about half.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-gear3k}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
TIMEFORMAT=%U
took() { { time OMP_NUM_THREADS=1 "$program" optimize "$@" --out "$work/out" --force --quiet >/dev/null; } 2>&1; }
row() { printf '%-28s %10.1f s %10.1f s\n' "$1" "$(took "$2" --certify)" "$(took "$2")"; }
printf '%-28s %12s %12s\n' job --certify 'all sets'
for job in printed_30 wrist_150 same_envelope_96; do row "$job" "examples/jobs/$job.toml"; done
for diameter in 80 100; do
  sed "s/^max_ring_root_diameter_mm = 70.0$/max_ring_root_diameter_mm = $diameter.0/" examples/jobs/printed_30.toml >"$work/task.toml"
  grep -q "= $diameter.0$" "$work/task.toml"
  row "printed_30 in $diameter mm" "$work/task.toml"
done
