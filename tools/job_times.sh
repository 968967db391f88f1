#!/usr/bin/env bash
# What the three jobs of examples/jobs take:
#   tools/job_times.sh [PROGRAM]      (gear3k unless stated; under a minute)
# Processor seconds of one thread, of the best design with its proof and of all tooth sets; two cores take about half.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-gear3k}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
TIMEFORMAT=%U
took() { { time OMP_NUM_THREADS=1 "$program" optimize "$@" --out "$work/out" --force --quiet >/dev/null; } 2>&1; }
printf '%-28s %12s %12s\n' job --certify 'all sets'
for job in printed_30 wrist_150 same_envelope_96; do
  printf '%-28s %10.1f s %10.1f s\n' "$job" "$(took "examples/jobs/$job.toml" --certify)" "$(took "examples/jobs/$job.toml")"
done
