# SPDX-License-Identifier: MIT
# cmake -DOUT=file.cpp -DDIR=folder -P embed.cmake NAME=file ...: text files as C++ string constants.
set(code "// Made by shaders/embed.cmake. Do not edit.\n#include \"kelp/shaders/shaders.h\"\n\nnamespace kelp::shaders {\n")
foreach(i RANGE ${CMAKE_ARGC})
  if("${CMAKE_ARGV${i}}" MATCHES "^(k[A-Za-z]+)=(.+)$")
    set(name ${CMAKE_MATCH_1})
    file(READ "${DIR}/${CMAKE_MATCH_2}" text)
    string(APPEND code "const char* const ${name} = R\"GLSL(${text})GLSL\";\n")
  endif()
endforeach()
file(WRITE "${OUT}" "${code}}  // namespace kelp::shaders\n")
