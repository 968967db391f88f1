# shellcheck shell=bash
# shellcheck disable=SC2154  # program is of who sources this
# Sourced: the commands of $program by their help, each followed by those below it.
commands_below() {
  local below
  # shellcheck disable=SC2048,SC2086  # words of a command, or none
  while read -r below; do
    echo "$*${*:+ }$below"
    commands_below $* $below
  done < <("$program" $* --help | sed -n '/^Subcommands:/,$ s/^  \([a-z]\+\) .*/\1/p')
}
