#!/usr/bin/env bash
# Runs a bare-metal program: run_qemu_system.sh MACHINE PROGRAM [ARGUMENT...]
# Text goes to stdout, the exit status is the program's. One instruction takes 64 ns of the guest's
# time, so its timers count instructions and every run is the same. CAIRN_QEMU_OPTIONS adds options
# (for example a plugin), CAIRN_QEMU_TIMEOUT changes the limit of 300 s.
set -euo pipefail
machine=$1
program=$2
shift 2

case $machine in
  virt) emulator=(qemu-system-riscv32 -bios none) ;;
  *) emulator=(qemu-system-arm) ;;
esac
semihosting=enable=on,target=native,chardev=text,arg=$(basename "$program")
for argument in "$@"; do
  semihosting+=,arg=${argument//,/,,}
done
# shellcheck disable=SC2086
exec timeout "${CAIRN_QEMU_TIMEOUT:-300}" "${emulator[@]}" -M "$machine" \
  -display none -monitor none -serial none -chardev stdio,id=text \
  -semihosting-config "$semihosting" -icount shift=6,sleep=off \
  ${CAIRN_QEMU_OPTIONS:-} -kernel "$program" </dev/null
