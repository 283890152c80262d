# Sourced by the scripts beside it: strict mode, the repository's root as working folder, and a few words they share.
# shellcheck shell=bash
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
jobs=${LODESTONE_JOBS:-$(nproc)}   # parallel compilers and tests; set LODESTONE_JOBS to limit them
export jobs

# One line on stderr, led by the name of the script that speaks.
say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }
die() { say "$*"; exit 1; }

# configure_and_build PRESET TARGET...: configures where needed, and builds these targets (all of them without any).
configure_and_build() {
  local preset=$1
  shift
  cmake --preset "$preset" >"$root/build/configure-$preset.log" 2>&1 ||
    { cat "$root/build/configure-$preset.log" >&2; die "cannot configure preset '$preset' (see above)"; }
  cmake --build --preset "$preset" -j "$jobs" ${1+--target "$@"}
}

mkdir -p build
