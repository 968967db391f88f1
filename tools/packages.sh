# shellcheck shell=bash
# shellcheck disable=SC2034  # the lists are for the scripts that source this
# Sourced by ./run and ./check: installs what is missing of the named Debian or Ubuntu packages.

build_packages="g++ cmake ninja-build pkg-config git libeigen3-dev libboost-dev libceres-dev coinor-libipopt-dev
libnlopt-dev libdxflib-dev librandom123-dev libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev
libsqlite3-dev gnuplot-nox"
check_packages="libgtest-dev libbenchmark-dev clang-format-14 clang-tidy-14 libomp-14-dev"
# The fuzzers' compiler, whose runtime has libFuzzer.
fuzz_packages="clang-14 libclang-rt-14-dev"

# A second program that opens the drawings; its test is skipped where it cannot be installed.
optional_check_packages="librecad"
# Runs the shards of a sweep; where it cannot be installed they run one after the other.
cluster_check_packages="slurmctld slurmd slurm-client munge"

install_missing() {
  local missing="" package
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
      missing="$missing $package"
  done
  [ -z "$missing" ] && return 0
  echo "Installing:$missing"
  local as_root=""
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
      echo "$0: packages are missing and neither root nor sudo is at hand; as root run:" >&2
      echo "  apt-get install --no-install-recommends$missing" >&2
      return 1
    fi
    as_root="sudo"
  fi
  # shellcheck disable=SC2086  # the lists are words on purpose
  $as_root apt-get update -qq &&
    $as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends $missing >/dev/null
}
