# Bare metal; no start-up files, no libstdc++. Included by the files per target, which set:
#   CAIRN_TARGET_TOOLS       prefix of the GNU toolchain's programs
#   CAIRN_TARGET_CPU_FLAGS   CPU and FPU options
#   CAIRN_TARGET_HAS_FLOAT   OFF: the CPU has no floating-point unit
#   CAIRN_BOARD_QEMU         machine of QEMU's system emulator that runs the programs
#   CAIRN_BOARD_*            memory and timer of that board (port/)
#   CAIRN_TARGET_CLANG       ON: Clang compiles, the GNU toolchain links
#   CAIRN_TARGET_OPTIMISATION  level of a release; -O2 where it is not set
# A build may say -DCAIRN_TARGET_DEBUG=-g1: names and lines without types are a third less to compile.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(cairn_language_flags "-fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit")
if(CAIRN_TARGET_CLANG)
  include(${CMAKE_CURRENT_LIST_DIR}/clang_for_arm_none_eabi.cmake)
else()
  set(CMAKE_C_COMPILER ${CAIRN_TARGET_TOOLS}-gcc)
  set(CMAKE_CXX_COMPILER ${CAIRN_TARGET_TOOLS}-g++)
  set(CMAKE_C_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS} ${cairn_c_headers}")
  set(CMAKE_CXX_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS} ${cairn_language_flags} ${cairn_target_headers}")
endif()
if(NOT DEFINED CAIRN_TARGET_HAS_FLOAT)
  set(CAIRN_TARGET_HAS_FLOAT ON)
endif()
if(NOT DEFINED CAIRN_TARGET_OPTIMISATION)
  set(CAIRN_TARGET_OPTIMISATION -O2)
endif()
set(CAIRN_TARGET_DEBUG -g CACHE STRING "Debug information of a release")
set(CMAKE_CXX_FLAGS_RELEASE_INIT "${CAIRN_TARGET_OPTIMISATION} ${CAIRN_TARGET_DEBUG} -DNDEBUG")
set(CMAKE_C_FLAGS_RELEASE_INIT "${CAIRN_TARGET_OPTIMISATION} ${CAIRN_TARGET_DEBUG} -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "${CAIRN_TARGET_OPTIMISATION} ${CAIRN_TARGET_DEBUG} -DNDEBUG" CACHE STRING "")
set(CMAKE_C_FLAGS_RELEASE "${CAIRN_TARGET_OPTIMISATION} ${CAIRN_TARGET_DEBUG} -DNDEBUG" CACHE STRING "")
set(CMAKE_EXECUTABLE_SUFFIX .elf)
set(CMAKE_EXECUTABLE_SUFFIX_C .elf)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_CURRENT_LIST_DIR}/run_qemu_system.sh ${CAIRN_BOARD_QEMU})
set(CAIRN_BARE_METAL ON)
