#!/usr/bin/env bash
# Prints the table of gear materials of docs/materials.md from data/gear_materials.csv.
set -euo pipefail
cd "$(dirname "$0")/.."
awk -F, '
  /^#/ || /^name,/ { next }
  function or_none(value) { return value == "" ? "-" : value }
  {
    hardness = $4 == "" ? "-" : ($4 == $5 ? $4 : $4 " to " $5) " " $3
    format = "%-37s %-8s %-15s %-12s %-12s %7s %5s %6s %6s\n"
    if (!begun++) printf format, "name", "group", "hardness", "sigma_Hlim", "sigma_Flim", "E", "nu", "kg/m3", "yield"
    flank = $6 ~ /T/ ? "curve" : or_none($6)
    root = $7 ~ /T/ ? "curve" : or_none($7)
    printf format, $1, $2 == "" ? "plastic" : $2, hardness, flank, root, or_none($8), or_none($9), or_none($10), or_none($11)
  }' data/gear_materials.csv
