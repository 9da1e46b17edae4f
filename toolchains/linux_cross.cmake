# Linux on another CPU: Debian's cross compiler, programs run under QEMU's user mode. Included by the
# files per target, which set:
#   CAIRN_TARGET_TRIPLE   prefix of the compiler and name of its folder in /usr
#   CAIRN_TARGET_QEMU     program that runs the target's programs
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${CAIRN_TARGET_TRIPLE}-gcc)
set(CMAKE_CXX_COMPILER ${CAIRN_TARGET_TRIPLE}-g++)
set(CMAKE_FIND_ROOT_PATH /usr/${CAIRN_TARGET_TRIPLE})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CAIRN_TARGET_QEMU} -L /usr/${CAIRN_TARGET_TRIPLE})
