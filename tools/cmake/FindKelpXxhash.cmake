# SPDX-License-Identifier: MIT
# Makes kelp_deps::xxhash from the host's target xxHash::xxhash, or from the installed header; kelp inlines it
# (XXH_INLINE_ALL), so there is nothing to link.
if(TARGET xxHash::xxhash)
  set(KelpXxhash_INCLUDE_DIR $<TARGET_PROPERTY:xxHash::xxhash,INTERFACE_INCLUDE_DIRECTORIES>)
else()
  find_path(KelpXxhash_INCLUDE_DIR xxhash.h)
  mark_as_advanced(KelpXxhash_INCLUDE_DIR)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KelpXxhash REQUIRED_VARS KelpXxhash_INCLUDE_DIR REASON_FAILURE_MESSAGE
  "install libxxhash-dev, make the target xxHash::xxhash first, or build with -DKELP_FETCH_DEPENDENCIES=ON")
if(KelpXxhash_FOUND AND NOT TARGET kelp_deps::xxhash)
  add_library(kelp_deps::xxhash INTERFACE IMPORTED)
  set_target_properties(kelp_deps::xxhash PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${KelpXxhash_INCLUDE_DIR}")
endif()
