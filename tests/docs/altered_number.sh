#!/usr/bin/env bash
# tools/docs.sh passes a document that it wrote and finds what was altered in it since:
#   altered_number.sh SOURCE_DIR GEAR3K
set -euo pipefail
source=$1 program=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
document=$folder/document.md

cat >"$document" <<'END'
<!-- output: gear3k mesh examples/pair_internal.toml --full | part 'Meshes' -->
```
```
<!-- file: pair.toml -->
```toml
name = 3
```
<!-- output exit 2: gear3k mesh pair.toml 2>&1 -->
```
```
<!-- run: gear3k export examples/designs/ratio_96_tolerances.toml --svg out --chord-error-um 100 -->
<!-- figure: out/S.svg -->
![the sun](S.svg)
<!-- output mask /[0-9.]+ s$/: echo it took 1.5 s -->
```
```
END
"$source/tools/docs.sh" --write "$program" "$document"
"$source/tools/docs.sh" "$program" "$document"

fails=0
# Alters the document or figure by a sed expression and expects that it is found ("differs") or passed ("agrees").
try() {
  local expected=$1 file=$2 expression=$3 what=$4 verdict=agrees
  cp "$file" "$folder/kept"
  sed -i -E "$expression" "$file"
  cmp -s "$file" "$folder/kept" && { echo "$what: the document was not altered"; fails=1; }
  "$source/tools/docs.sh" "$program" "$document" >"$folder/found" || verdict=differs
  if [ "$verdict" != "$expected" ]; then
    echo "$what: $verdict, expected: $expected"
    cat "$folder/found"
    fails=1
  fi
  cp "$folder/kept" "$file"
}
try differs "$document" '/^  1-2/ s/[0-9](\.[0-9])/8\1/' 'a digit of an output'
try differs "$document" '/^pair\.toml:1/ s/3/4/' 'a digit of a message'
try differs "$document" 's/exit 2: gear3k/exit 3: gear3k/' 'an exit code'
try differs "$document" 's/^name = 3/name = 4/' 'a digit of an input file'
try differs "$document" '0,/^\$ gear3k mesh/ s/^\$ gear3k mesh.*/$ gear3k mesh other.toml/' 'the command that is shown'
try differs "$folder/S.svg" '0,/[0-9]\.[0-9]+/ s/([0-9]\.[0-9]+)/9\1/' 'a digit of a figure'
try differs "$document" 's/^<!-- output mask.*/text/' 'an output without its command'
try agrees "$document" 's/took 1\.5 s/took 2.5 s/' 'a time'
exit $fails
