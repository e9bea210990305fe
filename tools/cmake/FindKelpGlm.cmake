# SPDX-License-Identifier: MIT
# Makes kelp_deps::glm from the target glm::glm: the host's, or that of an installed GLM. Exports name this
# target, so that the host's need not be in an export set.
if(NOT TARGET glm::glm)
  find_package(glm QUIET)
endif()
set(KelpGlm_TARGET "")
if(TARGET glm::glm)
  set(KelpGlm_TARGET glm::glm)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KelpGlm REQUIRED_VARS KelpGlm_TARGET REASON_FAILURE_MESSAGE
  "install libglm-dev, make the target glm::glm first, or build with -DKELP_FETCH_DEPENDENCIES=ON")
if(KelpGlm_FOUND AND NOT TARGET kelp_deps::glm)
  add_library(kelp_deps::glm INTERFACE IMPORTED)
  target_link_libraries(kelp_deps::glm INTERFACE ${KelpGlm_TARGET})
  get_target_property(imported ${KelpGlm_TARGET} IMPORTED)
  if(NOT imported)  # whose headers are not the system's; GLM's own warnings are not kelp's
    target_include_directories(kelp_deps::glm SYSTEM INTERFACE
      $<TARGET_PROPERTY:${KelpGlm_TARGET},INTERFACE_INCLUDE_DIRECTORIES>)
  endif()
endif()
