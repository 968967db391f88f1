#!/usr/bin/env bash
# Prints, for every identity that the tests check over random cases, the largest deviation as a share
# of the tolerance that the test states:   tools/accuracy.sh build/release [FOLDER[:FILTER]]...
# Without folders of tests those of random cases; FILTER as --gtest_filter.
# Of a test that runs over several kinds (external and internal, G2 below and above 1) the largest.
set -euo pipefail
build=$1
shift
[ $# -gt 0 ] || set -- geometry train backlash efficiency inertia design
export GEAR3K_LONG=1  # the long samples of the tests
records=$(mktemp -d)
trap 'rm -rf "$records"' EXIT
for tests in "$@"; do
  folder=${tests%%:*} filter=${tests#*:}
  [ "$filter" != "$tests" ] || filter='*'
  "$build/tests/${folder}_test" --gtest_filter="$filter" --gtest_output="xml:$records/$folder.xml" >/dev/null
done
for file in "$records"/*.xml; do
  awk -v folder="$(basename "$file" .xml)" '
    /<testcase /  { match($0, /name="[^"]*"/); test = substr($0, RSTART + 6, RLENGTH - 7)
                    match($0, /classname="[^"]*"/); suite = substr($0, RSTART + 11, RLENGTH - 12) }
    /_share_of_tolerance/ { match($0, /name="[^"]*"/); what = substr($0, RSTART + 6, RLENGTH - 7)
                    sub(/_share_of_tolerance/, "", what)
                    match($0, /value="[^"]*"/); value = substr($0, RSTART + 7, RLENGTH - 8)
                    sub(/\/.*/, "", test); sub(/.*\//, "", suite)
                    row = suite "." test ": " what
                    if (!(row in largest)) { rows[++count] = row; largest[row] = value }
                    if (value + 0 > largest[row] + 0) largest[row] = value }
    END { for (i = 1; i <= count; i++) printf "%-12s %8s  %s\n", folder, largest[rows[i]], rows[i] }' "$file"
done
