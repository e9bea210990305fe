# SPDX-License-Identifier: MIT
# kelp_add_pack(TARGET name SOURCE file [RIG file|preset] [OPTIONS option...] [OUTPUT file])
#
# Bakes a model into a pack as a step of the build. Comes with find_package(kelp), and with
# add_subdirectory(kelp).
#   TARGET   a target of the default build. The first call that names it makes it; more calls add packs to it.
#            Its property KELP_PACKS lists the packs: install(FILES $<TARGET_PROPERTY:name,KELP_PACKS> ...).
#            A program that needs them: add_dependencies(game name).
#   SOURCE   the model or volume, relative to the current source folder; or the absolute path of a file that
#            another rule of the same folder makes.
#   RIG      a rig file, relative to the current source folder, or a preset of kelp-bake. Without it:
#            STEM.rig.json beside the source, if there is one. CMake must run again to see a new one.
#   OPTIONS  other options of kelp-bake, see `kelp-bake --help`. --palette and --ramp name files relative
#            to the current source folder, after a space or a =. Generator expressions are allowed.
#   OUTPUT   default: STEM.kelp. Relative to CMAKE_RUNTIME_OUTPUT_DIRECTORY if that is set, else to the
#            current binary folder. With several configurations in one build, use $<CONFIG>/STEM.kelp.
#
# A pack is baked again when a file changes that its last bake read (buffers, textures, .mtl, rig, palette;
# kelp-bake lists them), when the options change, or when kelp-bake itself changes; not otherwise. It works
# with Ninja and Makefiles.
#
# The program that bakes is the first of these: KELP_BAKE_PROGRAM, if it is set; the target kelp::kelp-bake,
# installed with the package or built with kelp as a subdirectory (KELP_BAKER=ON); kelp-bake in PATH. When
# cross-compiling, kelp::kelp-bake does not run on this machine and is not used.
include_guard(GLOBAL)
cmake_policy(SET CMP0116 NEW)  # Ninja reads a rule's DEPFILE relative to the current binary folder

function(kelp_add_pack)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "TARGET;SOURCE;RIG;OUTPUT" "OPTIONS")
  if(DEFINED arg_UNPARSED_ARGUMENTS)
    list(GET arg_UNPARSED_ARGUMENTS 0 word)
    message(FATAL_ERROR "kelp_add_pack: '${word}' is not expected here; the keywords are TARGET, SOURCE, "
      "RIG, OPTIONS and OUTPUT")
  endif()
  foreach(keyword TARGET SOURCE)
    if(NOT arg_${keyword})
      message(FATAL_ERROR "kelp_add_pack: ${keyword} is missing; give at least TARGET name SOURCE file")
    endif()
  endforeach()
  if(DEFINED arg_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "kelp_add_pack: nothing follows ${arg_KEYWORDS_MISSING_VALUES}; give a value or "
      "leave it out")
  endif()
  if(TARGET ${arg_TARGET})
    get_target_property(packs ${arg_TARGET} KELP_PACKS)
    if(NOT packs)
      message(FATAL_ERROR "kelp_add_pack: TARGET ${arg_TARGET} exists and is no target of packs; choose "
        "another name, and add_dependencies(${arg_TARGET} name)")
    endif()
  endif()

  cmake_path(ABSOLUTE_PATH arg_SOURCE BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE
    OUTPUT_VARIABLE source)
  get_source_file_property(generated "${source}" GENERATED)
  if(IS_DIRECTORY "${source}" OR NOT (EXISTS "${source}" OR generated))
    message(FATAL_ERROR "kelp_add_pack: SOURCE ${source}: no such file, and no rule of this folder makes it")
  endif()
  set(depends "${source}")
  set(options "")
  kelp_pack_rig_()
  kelp_pack_options_()
  kelp_pack_output_()
  kelp_pack_baker_()

  # Files of the rule: what the bake read, and its options. The options are in a file because Make does not
  # look at a rule's text.
  cmake_path(GET output FILENAME file_name)
  string(SHA256 hash "${output}")
  string(SUBSTRING "${hash}" 0 8 hash)
  set(notes "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/kelp_packs")
  if(output MATCHES "\\$<")
    string(APPEND notes "/$<CONFIG>")
  endif()
  string(APPEND notes "/${file_name}-${hash}")
  list(JOIN options "\n" option_lines)
  file(GENERATE OUTPUT "${notes}.options"
    CONTENT "kelp ${kelp_VERSION}\n${baker}\n${rig_note}\n${option_lines}\n")

  # A target for each pack: only this folder knows its rule, and TARGET may belong to another folder.
  if(NOT TARGET ${arg_TARGET})
    add_custom_target(${arg_TARGET} ALL)
  endif()
  set_property(TARGET ${arg_TARGET} APPEND PROPERTY KELP_PACKS "${output}")
  get_target_property(packs ${arg_TARGET} KELP_PACKS)
  list(LENGTH packs count)
  set(own_target ${arg_TARGET}.${count})

  # Makefiles remember what former bakes read, and would bake again for ever once such a file is gone. Without
  # that memory they read the depfile.
  set(forget "")
  if(CMAKE_GENERATOR MATCHES "Makefiles")
    set(forget COMMAND ${CMAKE_COMMAND} -E rm -f
      "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${own_target}.dir/compiler_depend.internal")
  endif()
  cmake_path(GET output PARENT_PATH output_folder)
  add_custom_command(OUTPUT "${output}"
    COMMAND ${CMAKE_COMMAND} -E make_directory "${output_folder}"
    COMMAND ${baker} "${source}" -o "${output}" -MD -MF "${notes}.d" --progress none ${options}
    ${forget}
    DEPENDS ${baker} ${depends} "${notes}.options"
    DEPFILE "${notes}.d"
    COMMENT "Baking ${file_name}"
    COMMAND_EXPAND_LISTS VERBATIM)
  add_custom_target(${own_target} DEPENDS "${output}")
  add_dependencies(${arg_TARGET} ${own_target})
endfunction()

# The macros below are steps of kelp_add_pack and use its variables.

# RIG: adds to `depends` and `options`, or sets `rig_note` to the file that kelp-bake will find by itself.
macro(kelp_pack_rig_)
  set(rig_note "")
  if(DEFINED arg_RIG)
    set(rig_file "${arg_RIG}")
    cmake_path(ABSOLUTE_PATH rig_file BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
    get_source_file_property(generated "${rig_file}" GENERATED)
    if(EXISTS "${rig_file}" OR generated)
      list(APPEND options --rig "${rig_file}")
      list(APPEND depends "${rig_file}")
    elseif(arg_RIG MATCHES "^[a-z]+$")
      list(APPEND options --rig "${arg_RIG}")  # a preset; kelp-bake knows them
    else()
      message(FATAL_ERROR "kelp_add_pack: RIG ${rig_file}: no such file; give a rig file or a preset, "
        "such as sway")
    endif()
  else()
    # kelp-bake finds it by itself, and the depfile lists it. Noted here, so that a new file counts as a
    # changed option.
    cmake_path(REPLACE_EXTENSION source LAST_ONLY .rig.json OUTPUT_VARIABLE beside)
    if(EXISTS "${beside}")
      set(rig_note "${beside}")
    endif()
  endif()
endmacro()

# OPTIONS: adds to `options`, files to `depends`.
macro(kelp_pack_options_)
  set(previous "")
  foreach(option IN LISTS arg_OPTIONS)
    if(option MATCHES
      "^(-o.*|--output(=.*)?|-MD|-MF.*|-MT.*|--write-deps|--deps-file(=.*)?|--deps-target(=.*)?)$")
      message(FATAL_ERROR "kelp_add_pack: OPTIONS ${option}: kelp_add_pack gives this itself; OUTPUT says "
        "where the pack goes")
    elseif(option MATCHES "^--rig(=.*)?$")
      message(FATAL_ERROR "kelp_add_pack: OPTIONS ${option}: give the rig as RIG, so that a changed one is "
        "noticed")
    elseif(previous MATCHES "^--(palette|ramp)$")
      cmake_path(ABSOLUTE_PATH option BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
      list(APPEND depends "${option}")
    elseif(option MATCHES "^(--(palette|ramp))=(.+)$")
      set(name "${CMAKE_MATCH_1}")
      set(file "${CMAKE_MATCH_3}")
      cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
      list(APPEND depends "${file}")
      set(option "${name}=${file}")
    endif()
    list(APPEND options "${option}")
    set(previous "${option}")
  endforeach()
endmacro()

# OUTPUT: sets `output`, an absolute path that no other pack has.
macro(kelp_pack_output_)
  set(output "${arg_OUTPUT}")
  if(NOT DEFINED arg_OUTPUT)
    cmake_path(GET source STEM LAST_ONLY output)
    string(APPEND output .kelp)
  elseif(NOT output MATCHES "[.]kelp$")
    message(FATAL_ERROR "kelp_add_pack: OUTPUT ${output}: not the name of a pack; give a file that ends in "
      ".kelp")
  endif()
  set(base "${CMAKE_CURRENT_BINARY_DIR}")
  if(NOT "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}" STREQUAL "")
    set(base "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  endif()
  cmake_path(ABSOLUTE_PATH output BASE_DIRECTORY "${base}" NORMALIZE)
  get_property(others GLOBAL PROPERTY KELP_ALL_PACKS)
  if(output IN_LIST others)
    message(FATAL_ERROR "kelp_add_pack: ${output} is made by another kelp_add_pack; give one of them an "
      "OUTPUT of its own")
  endif()
  set_property(GLOBAL APPEND PROPERTY KELP_ALL_PACKS "${output}")
endmacro()

# Sets `baker` to a target or to a program's path.
macro(kelp_pack_baker_)
  if(NOT KELP_BAKE_PROGRAM AND NOT CMAKE_CROSSCOMPILING AND TARGET kelp::kelp-bake)
    set(baker kelp::kelp-bake)
  else()
    find_program(KELP_BAKE_PROGRAM kelp-bake NO_CMAKE_FIND_ROOT_PATH
      DOC "kelp-bake of the machine that builds, for kelp_add_pack")
    set(baker "${KELP_BAKE_PROGRAM}")
    if(NOT EXISTS "${baker}" OR IS_DIRECTORY "${baker}")
      message(FATAL_ERROR "kelp_add_pack: no kelp-bake that runs on this machine; install kelp's tools, or "
        "give -DKELP_BAKE_PROGRAM=/path/to/kelp-bake (kelp as a subdirectory builds it with -DKELP_BAKER=ON)")
    endif()
  endif()
endmacro()
