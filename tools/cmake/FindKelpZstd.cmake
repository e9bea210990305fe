# SPDX-License-Identifier: MIT
# Finds zstd (a static library if there is one, so that a game ships one file less) and makes the target
# kelp_deps::zstd.
find_path(KelpZstd_INCLUDE_DIR zstd.h)
find_library(KelpZstd_LIBRARY NAMES libzstd.a zstd)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KelpZstd REQUIRED_VARS KelpZstd_LIBRARY KelpZstd_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install libzstd-dev")
if(KelpZstd_FOUND AND NOT TARGET kelp_deps::zstd)
  add_library(kelp_deps::zstd UNKNOWN IMPORTED)
  set_target_properties(kelp_deps::zstd PROPERTIES IMPORTED_LOCATION "${KelpZstd_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${KelpZstd_INCLUDE_DIR}")
endif()
mark_as_advanced(KelpZstd_INCLUDE_DIR KelpZstd_LIBRARY)
