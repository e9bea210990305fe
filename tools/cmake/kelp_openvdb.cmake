# SPDX-License-Identifier: MIT
include_guard(GLOBAL)

# kelp_openvdb_sources(source...): sources of the current folder that use OpenVDB's templates. These hold
# static members that the program and libopenvdb must share: hidden, half of them would stay unset. What
# libopenvdb holds is not compiled again.
function(kelp_openvdb_sources)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS -fvisibility=default
    -fno-visibility-inlines-hidden "-include${PROJECT_SOURCE_DIR}/tools/cmake/openvdb_types.h")
endfunction()
