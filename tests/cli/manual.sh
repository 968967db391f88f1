#!/usr/bin/env bash
# The pages of the manual: manual.sh PROGRAM.  One for each command, with all that its --help has, the
# same bytes every time, and no word that groff warns of where man is installed.
set -euo pipefail
program=$(realpath "$1")
# shellcheck source=tests/cli/commands_below.sh
. "$(dirname "$0")/commands_below.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
failures=0
fail() {
  echo "$1"
  failures=$((failures + 1))
}

"$program" manual --out pages
TZ=Asia/Tokyo LC_ALL=C "$program" manual --out again
diff -r pages again

# Words of a page without what roff makes of them.
plain() { sed 's/\\-/-/g; s/\\f[BIR]//g; s/\\(aq/'"'"'/g' "$1"; }

mapfile -t commands < <(commands_below)
[ ${#commands[@]} -gt 10 ]
for command in "" "${commands[@]}"; do
  page=pages/man1/gear3k${command:+-${command// /-}}.1
  [ -f "$page" ] || { fail "$page: missing"; continue; }
  # shellcheck disable=SC2086  # no word for the program itself
  help=$("$program" $command --help)
  text=$(plain "$page")
  while read -r option; do
    grep -qE -- "^(-[a-z], )?$option( |\$)" <<<"$text" || fail "$page: no $option"
  done < <(sed -n 's/^  \(-[a-z],\)\?\(--[a-z-]*\).*/\2/p' <<<"$help")
  while read -r argument; do
    grep -qx -- "$argument" <<<"$text" || fail "$page: no argument $argument"
  done < <(sed -n '/^Positionals:/,/^$/ s/^  \([A-Z]\+\) .*/\1/p' <<<"$help")
  if [ -n "$command" ]; then
    name=${command// /-} above=${command% *}
    [ "$above" != "$command" ] || above=
    grep -q "^gear3k-$name(1)\$" < <(plain "pages/man1/gear3k${above:+-${above// /-}}.1") ||
      fail "the page above has no $command"
    cmp -s "$page" <("$program" manual "$name") || fail "manual $name: not its page"
  fi
done
grep -qx 3 pages/man1/gear3k.1

# Every key of `gear3k keys` has its line, in the order of the document.
# shellcheck disable=SC2016
diff <("$program" keys | sed -n 's/^| `\([^`]*\)`.*/\1/p') \
  <(sed -n 's/^\\fB\(.*\)\\fR = .*/\1/p' pages/man5/gear3k.5 | sed 's/\\-/-/g')

# All in one go, as man starts many programs for each.
if command -v groff >/dev/null 2>&1; then
  LC_ALL=C groff -man -Tutf8 -Kutf8 -ww -z pages/man?/* 2>warnings || fail "groff fails"
  [ ! -s warnings ] || fail "$(cat warnings)"
fi
[ "$failures" = 0 ]
