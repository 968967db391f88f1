#!/usr/bin/env bash
# How the best gearbox of examples/ratio-96.toml moves with its material and its face widths:
#   tools/compare_loads.sh [PROGRAM]      (gear3k unless stated; half a minute)
# Five tasks that differ in those tables alone; the numbers are those of refined.csv.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-gear3k}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

widths() { printf '[stage1]\nface_width_mm = %s\n[stage2]\nface_width_mm = %s\n' "$1" "$1"; }
fixed=8.0
free='{ min = 4.0, max = 16.0 }'
load_of() { sed -n '/^\[material\]/,$p' "$1"; }
table() { printf '%-8s %-10s %-19s %-13s %-31s %8s %8s %9s %8s\n' "$@"; }
table material 'face mm' teeth 'modules mm' 'shifts S P1 R1 P2 R2' eta_b 'T N m' 'gears kg' 'N m/rad'
task() {
  local material=$1 face=$2 width=$3 load=$4 out=$work/$1-$2
  {
    sed '/^# What it is to carry/,$d' examples/ratio-96.toml
    [ -z "$width" ] || widths "$width"
    [ -z "$load" ] || load_of "$load"
  } >"$out.toml"
  if ! "$program" optimize "$out.toml" --out "$out" --quiet >/dev/null 2>"$out.err"; then
    printf '%-8s %-10s %s\n' "$material" "$face" "$(sed -n 's/^the load forbids it: with every other limit kept /nothing carries it; /p' "$out.err")"
    return
  fi
  awk -F, -v material="$material" -v face="$face" '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    $column["status"] == "optimal" && $column["eta_b"] > most { most = $column["eta_b"]; row = $0 }
    function at(name) { return name in column ? value[column[name]] : "" }
    function shown(name, format) { return at(name) == "" ? "-" : sprintf(format, at(name)) }
    END {
      split(row, value, ",")
      if (at("b1_mm") != "" && face == "4 to 16") face = sprintf("%.1f %.1f", at("b1_mm"), at("b2_mm"))
      printf "%s\t%s\t%d/%d/%d/%d/%d\t%.3f %.3f\t%.3f %.3f %.3f %.3f %.3f\t%.2f %%\t%s\t%s\t%s\n", material,
        face, at("zS"), at("zP1"), at("zR1"), at("zP2"), at("zR2"), at("m1_mm"), at("m2_mm"), at("xS"),
        at("xP1"), at("xR1"), at("xP2"), at("xR2"), 100 * at("eta_b"), shown("torque_capacity_nm", "%.1f"),
        shown("mass_kg", "%.3f"), shown("torsional_stiffness_nm_per_rad", "%.0f")
    }' "$out/refined.csv" >"$out.row"
  IFS=$'\t' read -r -a cells <"$out.row"
  table "${cells[@]}"
}
task none - "" ""
task steel 8 "$fixed" examples/ratio-96.toml
task steel "4 to 16" "$free" examples/ratio-96.toml
task POM 8 "$fixed" examples/ratio-96-pom.toml
task POM "4 to 16" "$free" examples/ratio-96-pom.toml
