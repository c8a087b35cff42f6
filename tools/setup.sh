#!/usr/bin/env bash
# Installs every Debian 12 package that building, testing and demonstrating kiln needs, and the BC encoder of compiler/bake
# from the npm registry. Idempotent; works as root or with sudo.
# With --bench it adds the tools that bench/peers.sh measures against.
set -euo pipefail

packages=(
  # building
  build-essential cmake ninja-build ccache pkg-config
  glslang-dev spirv-tools spirv-headers libspirv-cross-c-shared-dev
  libyaml-cpp-dev libxxhash-dev libgmp-dev libssl-dev liblz4-dev liblmdb-dev libcurl4-openssl-dev libpng-dev libmimalloc-dev libboost-dev libzstd-dev
  prometheus-cpp-dev libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
  # running variants
  libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers
  # tests and checks
  libgtest-dev libgmock-dev libbenchmark-dev glslang-tools glslc spirv-cross clang clang-format clang-tidy libclang-rt-14-dev
  python3 python3-yaml python3-jsonschema git make curl nginx-extras bazel-bootstrap slurm-wlm munge zstd openssl groff-base
  chromium chromium-driver
)
bench=(qt6-shader-baker wrk)
for argument in "$@"; do
  case "$argument" in
    --bench) packages+=("${bench[@]}") ;;
    --help) echo "usage: tools/setup.sh [--bench]"; exit 0 ;;
    *) echo "setup.sh: unknown argument '$argument'" >&2; exit 2 ;;
  esac
done

# Node runs the BC encoder of compiler/bake; any Node from 18 on does, from wherever it came.
if ! command -v node >/dev/null; then packages+=(nodejs); fi
if ! command -v npm >/dev/null; then packages+=(npm); fi

# The encoder itself: one pinned package, beside the script that uses it.
install_bake() {
  local bake; bake="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/compiler/bake"
  local wanted; wanted=$(grep -o '"ktx2-encoder": "[0-9.]*"' "$bake/package.json" | cut -d'"' -f4)
  if grep -qs "\"version\": \"$wanted\"" "$bake/node_modules/ktx2-encoder/package.json"; then return 0; fi
  for attempt in 1 2 3; do
    if (cd "$bake" && npm install --no-package-lock --no-audit --no-fund --silent); then return 0; fi
    echo "setup: attempt $attempt failed" >&2
    sleep $((attempt * 5))
  done
  echo "setup.sh: could not install what compiler/bake/package.json names" >&2
  exit 3
}

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  install_bake
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: not root and no sudo; install: ${missing[*]}" >&2; exit 3; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
for attempt in 1 2 3; do
  if "${as_root[@]}" apt-get update -q && "${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"; then
    install_bake
    exit 0
  fi
  echo "setup: attempt $attempt failed" >&2
  sleep $((attempt * 5))
done
echo "setup.sh: could not install ${missing[*]}" >&2
exit 3
