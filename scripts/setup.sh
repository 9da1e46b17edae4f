#!/usr/bin/env bash
# Installs what is missing on Debian 12 and 13 and Ubuntu 24.04. Does nothing when all is there.
# scripts/setup.sh [--demo] [PACKAGE...]
#   --demo   only what building and running cairn_sim need; without it also what the tests of host and boards,
#            the linters and the experiments' pictures need
set -euo pipefail

packages=(
  build-essential cmake ninja-build
  libeigen3-dev libopencv-dev libcli11-dev nlohmann-json3-dev libyaml-cpp-dev libfmt-dev libjpeg-dev libboost-dev
  python3
)
if [ "${1:-}" = --demo ]; then
  shift
else
  packages+=(
    git clang clang-format clang-tidy libgtest-dev libbenchmark-dev librapidcheck-dev python3-matplotlib python3-pil valgrind
    xvfb xauth xdotool
    gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm llvm
    gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf
  )
  # QEMU's RISC-V machines; Debian 13 has them in a package of their own.
  # shellcheck disable=SC1091
  case $(. /etc/os-release && echo "$ID-$VERSION_ID") in
    debian-12 | ubuntu-*) packages+=(qemu-system-misc) ;;
    *) packages+=(qemu-system-riscv) ;;
  esac
fi
packages+=("$@")

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
