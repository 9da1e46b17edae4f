# Clang with the GNU toolchain's headers and linker. Enumerations are as short as GCC's, so that the
# libraries of both fit together.
function(cairn_gnu_path result)
  separate_arguments(flags UNIX_COMMAND "${CAIRN_TARGET_CPU_FLAGS}")
  execute_process(COMMAND arm-none-eabi-gcc ${flags} ${ARGN}
    OUTPUT_VARIABLE text OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(${result} ${text} PARENT_SCOPE)
endfunction()
cairn_gnu_path(gnu_version -dumpversion)
cairn_gnu_path(gnu_multilib -print-multi-directory)
cairn_gnu_path(gnu_archive -print-file-name=libc.a)
string(REGEX REPLACE "/lib/thumb/.*" "/include" gnu_headers "${gnu_archive}")
cmake_path(NORMAL_PATH gnu_headers)

set(CMAKE_C_COMPILER clang)
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_C_COMPILER_TARGET thumbv7em-none-eabihf)
set(CMAKE_CXX_COMPILER_TARGET thumbv7em-none-eabihf)
set(CMAKE_AR arm-none-eabi-ar)
set(CMAKE_RANLIB arm-none-eabi-ranlib)
set(CMAKE_NM arm-none-eabi-nm)
set(CMAKE_C_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS} -fshort-enums -isystem ${gnu_headers}")
string(JOIN " " CMAKE_CXX_FLAGS_INIT "${CAIRN_TARGET_CPU_FLAGS} ${cairn_language_flags} -fshort-enums"
  "-isystem ${gnu_headers}/c++/${gnu_version}"
  "-isystem ${gnu_headers}/c++/${gnu_version}/arm-none-eabi/${gnu_multilib}"
  "-isystem ${gnu_headers}")
set(CMAKE_CXX_LINK_EXECUTABLE
  "arm-none-eabi-g++ ${CAIRN_TARGET_CPU_FLAGS} -Wl,-z,noexecstack <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")
