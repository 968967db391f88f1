#!/usr/bin/env bash
# Makes the outputs and figures that stand in the documents and compares them with what stands there:
#   tools/docs.sh [--long] [--write] PROGRAM [DOCUMENT...]
# PROGRAM is gear3k in a build folder, e.g. build/release/gear3k; without DOCUMENT it is all *.md at the root and in docs/.
# Exit code 1 and the differences where there are any; with --write the documents and figures are changed instead.
#
# In a document, each on a line of its own:
#   <!-- output: COMMAND -->           the fenced block below is "$ COMMAND" and what it prints on stdout
#   <!-- output OPTIONS: COMMAND -->   options: "long" (only with --long), "exit N" (0 unless stated),
#                                      "mask /RE/" (matches count as equal: times, speeds)
#   <!-- run: COMMAND -->              the same without a block; "long" and "exit N" likewise
#   <!-- file: NAME -->                the fenced block below is written to NAME for the commands after it
#   <!-- figure: FILE -->              the image linked on the next line is FILE, which a command before has made
# A document with any of these has no other fenced block without a language: outputs have none, all else has one.
#
# Commands run once each, in order, in a scratch folder where examples/, data/, benchmarks/, tools/ ... are those of the
# sources, build/release is PROGRAM's folder, and `gear3k` is PROGRAM.  " | part ...", " 2>&1" and " >/dev/null" at the
# end are not shown:
#   COMMAND | part 'Gears' 'Meshes:1-3,6'
# prints those paragraphs of the output that begin so, and of Meshes these lines; [...] stands for what is left out.
set -euo pipefail

usage() { sed -n '2,/^set/ s/^# \{0,1\}//p' "$0" >&2; exit 1; }

write="" long="" program="" documents=()
for argument in "$@"; do
  case "$argument" in
    --write) write=1 ;;
    --long) long=1 ;;
    -*) usage ;;
    *) if [ -z "$program" ]; then program=$(realpath "$argument"); else documents+=("$(realpath "$argument")"); fi ;;
  esac
done
[ -n "$program" ] || usage
[ -x "$program" ] || { echo "$0: $program is not a program" >&2; exit 1; }
cd "$(dirname "$0")/.."
source=$PWD
if [ ${#documents[@]} -eq 0 ]; then
  mapfile -t documents < <(find "$source" "$source/docs" -maxdepth 1 -name '*.md' | LC_ALL=C sort)
  mapfile -t -O ${#documents[@]} documents < <(find "$source/docs" -mindepth 2 -name '*.md' | LC_ALL=C sort)
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
work=$scratch/work
mkdir -p "$work/build" "$work/out" "$scratch/bin" "$scratch/made"
for entry in benchmarks data docs examples src tests tools; do ln -s "$source/$entry" "$work/$entry"; done
ln -s "$(dirname "$program")" "$work/build/release"
ln -s "$program" "$scratch/bin/gear3k"
cat >"$scratch/bin/part" <<'PART'
#!/usr/bin/awk -f
function chosen(line, ranges,   list, limits, n, i) {
  if (ranges == "") return 1
  n = split(ranges, list, ",")
  for (i = 1; i <= n; i++) {
    split(list[i], limits, "-")
    if (line >= limits[1] + 0 && line <= (list[i] ~ /-/ ? limits[2] : limits[1]) + 0) return 1
  }
  return 0
}
function flush(   i, k) {
  if (length_ == 0) return
  for (k = 1; k <= parts; k++)
    if (index(text[1], begin[k]) == 1) break
  if (k > parts) left_out = 1
  else {
    found[k] = 1
    if (printed && !left_out) print ""
    for (i = 1; i <= length_; i++) {
      if (!chosen(i, ranges[k])) { left_out = 1; continue }
      if (left_out) print "[...]"
      left_out = 0
      print text[i]
    }
    printed = 1
  }
  length_ = 0
}
BEGIN {
  for (a = 1; a < ARGC; a++) {
    begin[++parts] = ARGV[a]
    if (match(ARGV[a], /:[0-9,-]+$/)) {
      ranges[parts] = substr(ARGV[a], RSTART + 1)
      begin[parts] = substr(ARGV[a], 1, RSTART - 1)
    }
  }
  ARGC = 1
}
/^$/ { flush(); next }
{ text[++length_] = $0 }
END {
  flush()
  if (left_out) print "[...]"
  for (k = 1; k <= parts; k++)
    if (!found[k]) { print "part: no paragraph begins with " begin[k] >"/dev/stderr"; status = 1 }
  exit status
}
PART
chmod +x "$scratch/bin/part"

marker='^<!-- (output|run|file|figure)( [^:]*)?: (.*) -->$'
image='^!\[[^]]*\]\(([^)]+)\)'
differences=0
differ() { echo "$1"; differences=1; }

# Runs what stands before " | part" once, then the filter; the result is in $scratch/result.
make_output() {
  local where=$1 command=$2 expected=$3
  local base=${command%% | part *} filter="" made status
  [ "$base" = "$command" ] || filter="part ${command#* | part }"
  made=$scratch/made/$(printf '%s' "$base" | md5sum | cut -d' ' -f1)
  if [ ! -f "$made.status" ]; then
    status=0
    (cd "$work" && PATH="$scratch/bin:$PATH" bash -c "$base") >"$made" 2>"$made.err" </dev/null || status=$?
    sed -i '/^[0-9]*\/[0-9]* .* left\(,\|$\)\|.* left; [0-9]*\/[0-9]* .*\|^[0-9]* % diagnosed/d' "$made"  # progress, where a machine is slow
    echo "$status" >"$made.status"
  fi
  status=$(cat "$made.status")
  if [ "$status" != "$expected" ]; then
    differ "$where: $base: exit code $status, not $expected"
    cat "$made.err"
  fi
  if [ -n "$filter" ]; then
    (cd "$work" && PATH="$scratch/bin:$PATH" bash -c "$filter") <"$made" >"$scratch/result" 2>"$scratch/error" ||
      differ "$where: $(cat "$scratch/error")"
  else
    cp "$made" "$scratch/result"
  fi
}

# A figure of another gnuplot may differ in every byte and is then taken as it is.
other_gnuplot=""
same_figure() {
  cmp -s "$1" "$2" && return 0
  local made stands
  made=$(grep -m1 -o 'GNUPLOT [^<]*[^< ]' "$1" || true)
  stands=$(grep -m1 -o 'GNUPLOT [^<]*[^< ]' "$2" 2>/dev/null || true)
  if [ -z "$made" ] || [ -z "$stands" ] || [ "$made" = "$stands" ]; then return 1; fi
  [ -n "$other_gnuplot" ] ||
    echo "figures by another gnuplot are not compared: made here, $made; in the documents, $stands"
  other_gnuplot=1
}

# The document in work: its lines, the next one to read, what it becomes.
name="" lines=() next=0 result=()

# Reads a fenced block from the next line on: its first line into $fence, its contents into $scratch/stands.
read_block() {
  fence=${lines[next]-}
  : >"$scratch/stands"
  [[ $fence =~ ^'```' ]] || return 1
  next=$((next + 1))
  while [ $next -lt ${#lines[@]} ] && [ "${lines[next]}" != '```' ]; do
    printf '%s\n' "${lines[next]}" >>"$scratch/stands"
    next=$((next + 1))
  done
  next=$((next + 1))
}

write_block() {
  result+=("$fence")
  mapfile -t -O ${#result[@]} result <"$scratch/stands"
  result+=('```')
}

# The command as the first line of its output shows it.
shown_command() {
  local shown=${1%% | part *}
  shown=${shown%' >/dev/null'}
  printf '$ %s\n' "${shown%' 2>&1'}"
}

# Compares $scratch/stands with what the command prints; with --write it is that afterwards.
compare_output() {
  local where=$1 command=$2 expected=$3 mask=$4 file
  make_output "$where" "$command" "$expected"
  { shown_command "$command"; sed 's/[[:space:]]*$//' "$scratch/result"; } >"$scratch/prints"
  for file in prints stands; do
    if [ -n "$mask" ]; then sed -E "s/$mask/#/g" "$scratch/$file"; else cat "$scratch/$file"; fi >"$scratch/$file.masked"
  done
  if cmp -s "$scratch/prints.masked" "$scratch/stands.masked"; then return; fi
  if [ -n "$write" ]; then
    cp "$scratch/prints" "$scratch/stands"
  else
    differ "$(diff -u --label "$where" --label "$command" "$scratch/stands.masked" "$scratch/prints.masked")"
  fi
}

# Compares the image that the next line links to with a file that a command has made.
compare_figure() {
  local where=$1 made=$work/$2 target=""
  if [[ ${lines[next]-} =~ $image ]]; then target=$folder/${BASH_REMATCH[1]}; fi
  if [ -z "$target" ]; then
    differ "$where: no image on the next line"
  elif [ ! -f "$made" ]; then
    differ "$where: no command above makes $2"
  elif same_figure "$made" "$target"; then
    return
  elif [ -n "$write" ]; then
    mkdir -p "$(dirname "$target")"
    cp "$made" "$target"
  else
    differ "$where: $(realpath -m --relative-to="$source" "$target") is not $2"
  fi
}

process() {
  local document=$1 marked="" line kind options rest where expected mask skip
  name=${document#"$source"/} folder=$(dirname "$document") next=0 result=()
  mapfile -t lines <"$document"
  if grep -Eq "$marker" "$document"; then marked=1; fi
  while [ $next -lt ${#lines[@]} ]; do
    line=${lines[next]} where="$name:$((next + 1))"
    if [[ $line =~ ^'```' ]]; then
      if [ -n "$marked" ] && [ "$line" = '```' ]; then
        differ "$where: a block without language and without <!-- output: COMMAND -->"
      fi
      read_block
      write_block
      continue
    fi
    result+=("$line")
    next=$((next + 1))
    [[ $line =~ $marker ]] || continue
    kind=${BASH_REMATCH[1]} options=${BASH_REMATCH[2]} rest=${BASH_REMATCH[3]}
    expected=0 mask="" skip=""
    if [[ $options =~ 'exit '([0-9]+) ]]; then expected=${BASH_REMATCH[1]}; fi
    if [[ $options =~ 'mask /'(.*)'/' ]]; then mask=${BASH_REMATCH[1]}; fi
    if [[ $options =~ ' long'( |$) ]] && [ -z "$long" ]; then skip=1; fi
    case "$kind" in
      run) [ -n "$skip" ] || make_output "$where" "$rest" "$expected" ;;
      figure) [ -n "$skip" ] || compare_figure "$where" "$rest" ;;
      *)
        if ! read_block; then
          differ "$where: no fenced block on the next line"
        elif [ "$kind" = file ]; then
          mkdir -p "$(dirname "$work/$rest")"
          cp "$scratch/stands" "$work/$rest"
          write_block
        else
          if [ -z "$skip" ]; then
            compare_output "$where" "$rest" "$expected" "$mask"
          elif [ "$(head -1 "$scratch/stands")" != "$(shown_command "$rest")" ]; then
            differ "$where: the block is not the output of this command"
          fi
          write_block
        fi
        ;;
    esac
  done
  if [ -n "$write" ] && ! printf '%s\n' "${result[@]}" | cmp -s - "$document"; then
    printf '%s\n' "${result[@]}" >"$document"
    echo "$name written"
  fi
}

for document in "${documents[@]}"; do process "$document"; done
exit $differences
