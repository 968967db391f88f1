#!/usr/bin/env bash
# clang-tidy over the sources that changed since they were last found clean: of src/ and the test
# benches; with GEAR3K_LONG=1 of all tests, benchmarks, fuzzers and examples too, and with all checks:
#   tools/tidy.sh BUILD_DIR [GROUP]...    (configured with GEAR3K_UNITY, and built: its dependencies
#                                          are used; a group has the name of its first target)
# Most of the time of clang-tidy goes into the headers of the libraries.  So the sources are read in
# groups, each as one large source, and a group is read again when a file that it includes, its
# options or the checks changed.  Findings in headers count for every folder (.clang-tidy).
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
build=$(cd "$1" && pwd)
shift
work=$build/tidy
mkdir -p "$work"

# Targets that are read together, the longest first; a target that is not named is a group by itself.
groups=(
  "gear3k_calibrate gear3k_calibrate_seldom"
  "calibrate_test gear3k_rig rig_test"
  "gear3k_io gear3k_report gear3k_drawing gear3k_papers"
  "units_test geometry_test train_test backlash_test efficiency_test inertia_test strength_test"
  "gear3k_units gear3k_numerics gear3k_geometry gear3k_train gear3k_backlash gear3k_efficiency
    gear3k_inertia gear3k_strength gear3k_design"
  "io_test report_test drawing_test papers_test"
  "design_test optimize_test"
  "gear3k_app gear3k_cli gear3k"
  "cli_test app_test"
  "gear3k_optimize gear3k_optimize_seldom"
  "BENCHMARKS"
)

# units: "target TAB object TAB source" of every source, those of a large source one by one.
# commands/TARGET: the command that compiles it, without its source and object, as it stands in JSON.
rm -rf "$work/commands" "$work/new"
mkdir -p "$work/commands" "$work/new"
awk -v root="$root/" -v commands="$work/commands/" '
  /^  "command": / { command = $0; sub(/^  "command": "/, "", command); sub(/",?$/, "", command) }
  /^  "file": / {
    file = $0; sub(/^  "file": "/, "", file); sub(/",?$/, "", file)
    object = command; sub(/.* -o /, "", object); sub(/ .*/, "", object)
    target = object; sub(/\.dir\/.*/, "", target); sub(/.*\//, "", target)
    if (object ~ /^(benchmarks|fuzz|examples)\//) target = "BENCHMARKS"
    sub(/ -o .*/, "", command)
    gsub(/ --param=[^ ]*/, "", command)  # of GCC
    sub(/ -DFMT_CONSTEVAL=[^ ]*/, "", command)  # formats are checked here
    print command >(commands target)
    if (file !~ /\/Unity\/unity_[0-9]+_cxx\.cxx$/) { print target "\t" object "\t" file; next }
    while ((getline line < file) > 0)
      if (line ~ /^#include "/) { split(line, part, "\""); print target "\t" object "\t" part[2] }
  }' "$build/compile_commands.json" >"$work/units"

# Left to GEAR3K_LONG=1: together a fifth of the time, nearly all of it in headers of libraries, for
# what the compiler warns of as well (-Wempty-body), for functions of C that no source calls
# (strings, allocation), or for style.
seldom_checks=(
  bugprone-not-null-terminated-result
  bugprone-sizeof-expression
  bugprone-suspicious-semicolon
  bugprone-suspicious-string-compare
  bugprone-undelegated-constructor
  bugprone-unused-raii
  modernize-use-nullptr
  performance-unnecessary-value-param
  readability-redundant-control-flow
  readability-redundant-declaration
)
seldom=$(printf ',-%s' "${seldom_checks[@]}")
seldom=${seldom#,}

# A word of such a command; blanks may stand between quotes.
escaped='\\\\(\\.|[^\])'
word="(\\\\\"($escaped|[^\"\\\\])*\\\\\"|$escaped|[^ \"\\\\])+"

# One source per group, and one compile_commands.json for them.
entries=
list=
add_group() {
  local name=$1 source=$work/new/$1.cpp target command n=0 path
  local added=()
  shift
  : >"$work/new/$name.objects"
  for target in "$@"; do
    [ -f "$work/commands/$target" ] || continue
    command=$(tail -n 1 "$work/commands/$target")
    # What the others define and include besides.
    command+=$(sort -u "$work/commands/$target" "${added[@]}" | grep -oE "$word" | awk '
      separate { print $0; separate = 0; next }
      /^-isystem$/ { printf "%s ", $0; separate = 1; next }
      /^-[DI]./' | awk '!seen[$0]++ { printf " %s", $0 }')
    added+=("$work/commands/$target")
    awk -F '\t' -v t="$target" '$1 == t { print $2 }' "$work/units" |
      sort -u >>"$work/new/$name.objects"
  done
  [ -s "$work/new/$name.objects" ] || return 0
  for target in "$@"; do
    awk -F '\t' -v t="$target" '$1 == t { print $3 }' "$work/units"
  done | awk -v build="$build/" '!seen[$0]++ && index($0, build) != 1' | while read -r path; do
    n=$((n + 1))
    # Programs of their own: each has an entry, of the same name.
    [ "$name" = BENCHMARKS ] && printf '#define main main_%d\n' "$n"
    printf '// NOLINTNEXTLINE(bugprone-suspicious-include)\n#include "%s"\n' "$path"
    [ "$name" = BENCHMARKS ] && printf '#undef main\n'
    true
  done >"$source"
  cmp -s "$source" "$work/$name.cpp" || cp "$source" "$work/$name.cpp"
  printf '%s\n' "$command" >"$work/new/$name.command"
  entries+="${entries:+,}{\"directory\": \"$build\", \"file\": \"$work/$name.cpp\",
\"command\": \"$command -c \\\"$work/$name.cpp\\\"\"}"
  list+="$name"$'\n'
}
named=" "
for group in "${groups[@]}"; do
  # shellcheck disable=SC2086  # a group is a list of words
  add_group "${group%% *}" $group
  named+="${group//$'\n'/ } "
done
while read -r target; do
  case $named in *" $target "*) ;; *) add_group "$target" "$target" ;; esac
done < <(cut -f 1 "$work/units" | sort -u)
printf '[%s]\n' "$entries" >"$work/compile_commands.json"

# What a group depends on, as one number: the files of the project that its objects were made from.
state_of() {
  {
    cat "$work/$1.cpp" "$work/new/$1.command"
    xargs -d '\n' ninja -C "$build" -t deps <"$work/new/$1.objects" |
      awk -v root="$root/" -v build="$build/" '
        / deps not found/ { print > "/dev/stderr"; exit 1 }
        /^    / { path = substr($0, 5); if (path !~ /^\//) path = build path
                  if (index(path, root) == 1 && index(path, build) != 1) print path }' |
      sort -u | xargs -d '\n' sha256sum "$root/.clang-tidy" "$root/tools/tidy.sh"
  } | sha256sum
}
tidy_group() {
  local name=$1 state begin=$EPOCHSECONDS checks=() extent=long
  state=$(state_of "$name") || return 1
  [ -f "$work/$name.long.clean" ] && [ "$(cat "$work/$name.long.clean")" = "$state" ] && return 0
  if [ "${GEAR3K_LONG:-0}" != 1 ]; then
    checks=("--checks=$seldom")
    extent=short
    [ -f "$work/$name.short.clean" ] && [ "$(cat "$work/$name.short.clean")" = "$state" ] && return 0
  fi
  # What clang-tidy says on stderr (counts of suppressed warnings) matters only when it fails.
  if clang-tidy-14 --quiet -p "$work" "${checks[@]}" "$work/$name.cpp" 2>"$work/$name.err"; then
    printf '%s\n' "$state" >"$work/$name.$extent.clean"
    printf '%-24s clean, %4d s\n' "$name" $((EPOCHSECONDS - begin))
  else
    cat "$work/$name.err" >&2
    return 1
  fi
}
export -f tidy_group state_of
export root build work seldom
if [ $# -gt 0 ]; then
  list=$(printf '%s\n' "$@")
elif [ "${GEAR3K_LONG:-0}" != 1 ]; then
  # ./check long reads all.
  list=$(grep '^gear3k_' <<<"$list")
fi
printf '%s' "$list" | xargs -P "$(nproc)" -I{} bash -c 'set -o pipefail; tidy_group {}'
