# SPDX-License-Identifier: MIT
# Windows (64 bits) from Linux, by mingw-w64. The posix flavour: the other has no std::thread.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)  # programs that need no DLL of the compiler beside them
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32 ${KELP_PORT_PREFIX})  # of the latter, kelp's dependencies
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES KELP_PORT_PREFIX)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
