#!/usr/bin/env bash
# clang-tidy over the sources of src/ that changed since their last clean pass:
#   tools/tidy.sh BUILD_DIR    (a folder with compile_commands.json)
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1
stamps=$build/tidy
mkdir -p "$stamps"

tidy_one() {
  local file=$1 stamp
  stamp=$stamps/$(echo "$file" | tr / _)
  # Headers count for every file: a change of any makes all stamps stale.
  if [ -f "$stamp" ] && [ "$stamp" -nt "$file" ] && [ "$stamp" -nt "$stamps/headers" ]; then
    return 0
  fi
  # What clang-tidy says on stderr (counts of suppressed warnings) matters only when it fails.
  if clang-tidy-14 --quiet -p "$build" "$file" 2>"$stamp.err"; then
    touch "$stamp"
  else
    cat "$stamp.err" >&2
    return 1
  fi
}
export -f tidy_one
export build stamps

newest=$(find src .clang-tidy -name '*.hpp' -newer "$stamps/headers" -o -name .clang-tidy \
  -newer "$stamps/headers" 2>/dev/null || true)
if [ ! -f "$stamps/headers" ] || [ -n "$newest" ]; then
  touch "$stamps/headers"
  sleep 0.01
fi
find src -name '*.cpp' | sort | xargs -P "$(nproc)" -I{} bash -c 'tidy_one {}'
