#!/usr/bin/env bash
# Installs what building, testing and running need on Debian 12, and packages named as arguments.
# Does nothing when all is there.
set -euo pipefail

packages=(
  build-essential cmake ninja-build git clang clang-format clang-tidy
  libeigen3-dev libopencv-dev libgtest-dev libbenchmark-dev librapidcheck-dev
  libcli11-dev nlohmann-json3-dev libyaml-cpp-dev libfmt-dev libboost-dev
  python3 python3-matplotlib valgrind
  gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm llvm
  "$@"
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=()
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
  as_root=(sudo)
else
  echo "setup: neither root nor sudo. Install these packages and run again:" >&2
  echo "  apt-get install ${missing[*]}" >&2
  exit 1
fi
echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"
