#!/usr/bin/env bash
# What choosing gearbox and motor of examples/actuators/knee_co_design.toml together gains over choosing them one after
# the other:
#   tools/co_design_gain.sh [PROGRAM]      (gear3k unless stated)
# One after the other: the gearbox of most backward efficiency within 2 % of a ratio, in the same envelope, then the
# motor of the catalogue that needs least for the stride with it.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-gear3k}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
spec=examples/actuators/knee_co_design.toml
root=$PWD
# The motors and the drive of the SPEC: up to its greatest mass, of known friction.
awk -F, '
  /^#/ { next }
  !header { for (i = 1; i <= NF; ++i) at[$i] = i; header = 1; print; next }
  function has(name) { return $at[name] != "" }
  !has("mass_kg") || $at["mass_kg"] > 0.3 { next }
  has("coulomb_torque_nm") || has("viscous_nms_per_rad") || (has("no_load_current_a") && has("no_load_speed_rad_s"))
  ' data/motor_catalogue.csv >"$work/motors.csv"
grep -q '^limits.max_motor_mass_kg = 0.3$' "$spec" && grep -q '^limits.known_friction = true' "$spec"
drive=$(sed -n 's/^drive\.//p' "$spec")

line() { printf '%-22s %-16s %8s %8s %8s  %-34s %9s\n' "$@"; }
value() { sed -n "s/^ *\"$2\": \"\\{0,1\\}\\([^\",]*\\)\"\\{0,1\\},\\{0,1\\}$/\\1/p" "$1" | head -1; }
teeth() {
  awk -F, -v eta="$(value "$1/summary.json" eta_b)" 'NR > 1 && $9 == eta { print $1 "/" $2 "/" $3 "/" $4 "/" $5; exit }' \
    "$1/refined.csv"
}
percent() { awk -v x="$1" 'BEGIN { printf "%.2f %%", 100 * x }'; }
line choice teeth ratio eta_f eta_b motor 'J/stride'

# The most efficient gearbox of the envelope at a ratio, and the best motor for it.
gearbox_first() {
  awk -v target="$1" -v tolerance="$2" '
    /^objective/ { $0 = "objective = \"backward_efficiency\"" }
    /^target/ { $0 = "target = " target }
    /^tolerance/ { $0 = "tolerance = " tolerance }
    { print }' "$spec" >"$work/gearbox.toml"
  "$program" optimize "$work/gearbox.toml" --certify --force --out "$work/gearbox" --quiet >/dev/null
  cat >"$work/select.toml" <<END
motors = "$work/motors.csv"
gearboxes = "$work/gearbox/best.toml"
cycles = "$root/examples/actuators/knee_walking.csv"
objective = "energy"
[drive]
$drive
END
  local summary=$work/gearbox/summary.json motor="none within its limits" energy=-
  if "$program" actuator --select "$work/select.toml" --out "$work/select" --quiet >/dev/null 2>&1; then
    motor=$(value "$work/select/summary.json" motor)
    energy=$(printf %.4f "$(value "$work/select/summary.json" energy_j)")
  fi
  line "$3" "$(teeth "$work/gearbox")" "$(printf %.2f "$(value "$summary" ratio)")" "$(percent "$(value "$summary" eta_f)")" \
    "$(percent "$(value "$summary" eta_b)")" "$motor" "$energy"
}
for ratio in 30 40 50 60 80 90 100 120; do gearbox_first "$ratio" 0.02 "gearbox first, $ratio:1"; done
gearbox_first 75.0 0.6 'gearbox first, any'
"$program" optimize "$spec" --certify --out "$work/both" --quiet >/dev/null
summary=$work/both/summary.json
line together "$(teeth "$work/both")" "$(printf %.2f "$(value "$summary" ratio)")" "$(percent "$(value "$summary" eta_f)")" \
  "$(percent "$(value "$summary" eta_b)")" "$(value "$summary" motor)" "$(printf %.4f "$(value "$summary" energy_j)")"
printf 'proven: none of these motors with any of these gearboxes needs less than %.4f J\n' "$(value "$summary" bound_j)"
