# SPDX-License-Identifier: MIT
# Games that have kelp in their own build: each is built, run and installed, and installs itself alone.
# ZSTD_SOURCE is zstd's source (tests/ports.sh hosts). Without it, headers stand in for what kelp fetches of
# zstd, and the installed library is linked.
include(${TEST_DIR}/steps.cmake)
include(${TEST_DIR}/copies.cmake)
file(REMOVE_RECURSE ${WORK_DIR})
make_copies(${WORK_DIR}/copies)
set(fetched
  -DFETCHCONTENT_SOURCE_DIR_KELP_GLM=${WORK_DIR}/copies/glm
  -DFETCHCONTENT_SOURCE_DIR_KELP_XXHASH=${WORK_DIR}/copies/xxhash
  -DFETCHCONTENT_SOURCE_DIR_KELP_ZSTD=${WORK_DIR}/copies/zstd)
if(NOT ZSTD_SOURCE)
  list(APPEND fetched "-DCMAKE_CXX_STANDARD_LIBRARIES=${ZSTD_LIBRARY}")
endif()

# Where no compiler cache is used, one of this test's own compiles only once what two hosts have in common.
if(DEFINED ENV{CCACHE_DISABLE})
  unset(ENV{CCACHE_DISABLE})
  set(ENV{CCACHE_DIR} ${WORK_DIR}/ccache)
  set(ENV{CCACHE_BASEDIR} ${WORK_DIR})
endif()

# check_host(NAME KELP_FROM DEPENDENCIES [cache entries...])
function(check_host name kelp_from dependencies)
  set(build ${WORK_DIR}/${name})
  step("configuring ${name}" ${CMAKE_COMMAND} -S ${TEST_DIR}/host -B ${build} -G ${GENERATOR}
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=24 -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
    -DKELP_FROM=${kelp_from} -DDEPENDENCIES=${dependencies} -DKELP_SOURCE_DIR=${KELP_SOURCE_DIR}
    -DCOPIES=${WORK_DIR}/copies -DZSTD_LIBRARY=${ZSTD_LIBRARY} ${ARGN})
  if(NOT dependencies STREQUAL "system")
    file(READ ${build}/compile_commands.json commands)
    foreach(folder glm xxhash zstd/lib)
      if(NOT commands MATCHES "${WORK_DIR}/copies/${folder}")
        message(FATAL_ERROR "${name}: kelp is not compiled with ${WORK_DIR}/copies/${folder}")
      endif()
    endforeach()
    file(STRINGS ${build}/CMakeCache.txt searched REGEX "^(Kelp(Zstd|Xxhash)_|glm_DIR)")
    if(searched)
      message(FATAL_ERROR "${name}: kelp searched this machine: ${searched}")
    endif()
  endif()
  step("building ${name}" ${CMAKE_COMMAND} --build ${build} --target host --parallel 2)
  step("running ${name}" ${build}/host ${KELP_SOURCE_DIR}/tests/formats/golden/solid.kelp)
  step("installing ${name}" ${CMAKE_COMMAND} --install ${build} --prefix ${build}/prefix)
  file(GLOB_RECURSE installed RELATIVE ${build}/prefix ${build}/prefix/*)
  if(NOT installed STREQUAL "bin/host")
    message(FATAL_ERROR "${name} installs more than itself: ${installed}")
  endif()
endfunction()

check_host(subdirectory subdirectory system)
check_host(own fetched own)
check_host(none fetched none ${fetched})

# A package of kelp that was built with a host's GLM names no target of it.
step("configuring a package" ${CMAKE_COMMAND} -S ${TEST_DIR}/host -B ${WORK_DIR}/own -DKELP_INSTALL=ON)
