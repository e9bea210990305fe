# SPDX-License-Identifier: MIT
# cmake -DOUT=file.cpp -DDIR=folder [-DHEADER=file.h -DSPACE=namespace] -P embed.cmake NAME=file ...
# Writes text files as C++ string constants. The header declares them.
if(NOT DEFINED HEADER)
  set(HEADER kelp/shaders/shaders.h)
  set(SPACE kelp::shaders)
endif()
set(code "// Made by shaders/embed.cmake. Do not edit.\n#include \"${HEADER}\"\n\nnamespace ${SPACE} {\n")
foreach(i RANGE ${CMAKE_ARGC})
  if("${CMAKE_ARGV${i}}" MATCHES "^(k[A-Za-z]+)=(.+)$")
    set(name ${CMAKE_MATCH_1})
    file(READ "${DIR}/${CMAKE_MATCH_2}" text)
    string(APPEND code "const char* const ${name} = R\"GLSL(${text})GLSL\";\n")
  endif()
endforeach()
file(WRITE "${OUT}" "${code}}  // namespace ${SPACE}\n")
