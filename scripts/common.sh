# Sourced by the scripts beside it: strict mode, the repository's root as working folder, and shared functions.
# shellcheck shell=bash
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
jobs=${LODESTONE_JOBS:-$(nproc)}   # parallel compilers and tests; set LODESTONE_JOBS to limit them
export jobs

# Prints one line to stderr, after the name of the script.
say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }
die() { say "$*"; exit 1; }

# configure_and_build PRESET [TARGET...]: configures where needed, and builds the targets (all if none is named).
configure_and_build() {
  local preset=$1
  shift
  cmake --preset "$preset" >"$root/build/configure-$preset.log" 2>&1 ||
    { cat "$root/build/configure-$preset.log" >&2; die "cannot configure preset '$preset' (see above)"; }
  cmake --build --preset "$preset" -j "$jobs" ${1+--target "$@"}
}

mkdir -p build
