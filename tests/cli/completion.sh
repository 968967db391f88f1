#!/usr/bin/env bash
# The completion of bash as a user meets it: completion.sh PROGRAM.  Sourced, then asked for what
# follows words, in a folder with files of three kinds.
set -euo pipefail
program=$(realpath "$1")
# shellcheck source=tests/cli/commands_below.sh
. "$(dirname "$0")/commands_below.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
touch task.toml 'my gear.toml' data.csv notes.txt
mkdir out
"$program" completion >completion.bash
# shellcheck disable=SC1091
. ./completion.bash
failures=0

# What is offered for the last of the words: a line each, sorted.
offered() {
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _gear3k
  printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort
}

# expect WORDS... : OFFERED...: all that is offered, in this order.
expect() {
  local words=() wanted got
  while [ "$1" != ":" ]; do words+=("$1"); shift; done
  shift
  wanted=$(printf '%s\n' "$@")
  got=$(offered "${words[@]}")
  [ "$got" = "$wanted" ] && return 0
  printf 'after "%s" it offers:\n%s\ninstead of:\n%s\n' "${words[*]}" "$got" "$wanted"
  failures=$((failures + 1))
}

[ "$(complete -p gear3k)" = "complete -F _gear3k gear3k" ] || failures=$((failures + 1))
expect gear3k opt : optimize
expect gear3k an : analyze
expect gear3k -- : --help --version
expect gear3k optimize --re : --resume
expect gear3k optimize task.toml --fo : --force --format
expect gear3k optimize "" : "my gear.toml" out task.toml
expect gear3k optimize ta : task.toml
expect gear3k optimize ./ta : ./task.toml
expect gear3k optimize --out "" : out
expect gear3k optimize --format j : json
expect gear3k optimize --format = j : json      # as bash splits --format=j
expect gear3k optimize --format = : csv json table
expect gear3k optimize --quiet ta : task.toml   # a flag takes no value
expect gear3k analyze --show ge : gears
expect gear3k analyze --show gears,te : gears,teeth
expect gear3k diagnose da : ""                  # no TOML begins so
expect gear3k diagnose task.toml da : data.csv
expect gear3k diagnose task.toml data.csv --quiet da : data.csv
expect gear3k compare task.toml task.toml my : "my gear.toml"
expect gear3k analyze task.toml --out no : notes.txt
expect gear3k actuator --motor sh : shorted
expect gear3k new sc : scenario
expect gear3k new task "" : ""
expect gear3k keys max_coax : max_coaxial_offset
expect gear3k manual opt : optimize
expect gear3k sweep st : status
expect gear3k sweep ta : task.toml
expect gear3k sweep merge no : notes.txt
expect gear3k sweep best notes.txt --by eta : ""
expect gear3k unheard : ""

# Every command of --help is offered, and every long option of its own help.
mapfile -t commands < <(commands_below)
[ ${#commands[@]} -gt 10 ]
# shellcheck disable=SC2046
expect gear3k "" : $(printf '%s\n' "${commands[@]}" | grep -v ' ' | LC_ALL=C sort)
for command in "${commands[@]}"; do
  # shellcheck disable=SC2046,SC2086
  expect gear3k $command -- : $("$program" $command --help |
    sed -n 's/^  \(-[a-z],\)\?\(--[a-z-]*\).*/\2/p' | LC_ALL=C sort)
done
[ "$failures" = 0 ]
