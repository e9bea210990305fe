# SPDX-License-Identifier: MIT
# Finds xxhash's header; kelp inlines it (XXH_INLINE_ALL), so there is nothing to link. Makes the target
# kelp_deps::xxhash.
find_path(KelpXxhash_INCLUDE_DIR xxhash.h)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KelpXxhash REQUIRED_VARS KelpXxhash_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install libxxhash-dev")
if(KelpXxhash_FOUND AND NOT TARGET kelp_deps::xxhash)
  add_library(kelp_deps::xxhash INTERFACE IMPORTED)
  set_target_properties(kelp_deps::xxhash PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${KelpXxhash_INCLUDE_DIR}")
endif()
mark_as_advanced(KelpXxhash_INCLUDE_DIR)
