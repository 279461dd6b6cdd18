# SPDX-License-Identifier: MIT
# The models once more, in double precision: the laboratory compares with them and integrates by them.
#
# double_sources.cmake writes copies of the files of src/bsdf and of what they stand on, in which constants have lost the
# suffix f; src/lab/double/prefix.h, read before each, makes float a word for double and gives external names an ending.
# New models need nothing: the folders are listed anew by each build.
set(double_folder ${CMAKE_CURRENT_BINARY_DIR}/double)
file(GLOB double_inputs CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/src src/math/*.[ch] src/spectrum/*.[ch] src/sample/*.[ch]
  src/measured/*.h src/bsdf/*.[ch])
# fitted tables of floats, and what rests on a float's bits: no model needs them
list(FILTER double_inputs EXCLUDE REGEX "^spectrum/(rgb|wavelengths)\\.c$")
set(double_outputs ${double_inputs})
list(TRANSFORM double_outputs PREPEND ${double_folder}/)
set(double_from ${double_inputs})
list(TRANSFORM double_from PREPEND ${CMAKE_SOURCE_DIR}/src/)
file(WRITE ${double_folder}/list.txt.new "${double_inputs}\n")
file(COPY_FILE ${double_folder}/list.txt.new ${double_folder}/list.txt ONLY_IF_DIFFERENT)
set(double_headers ${double_outputs})
list(FILTER double_headers INCLUDE REGEX "\\.h$")
list(APPEND double_headers ${double_folder}/double_names.h ${double_folder}/double_system.h)
set(double_compiled ${double_outputs})
list(FILTER double_compiled INCLUDE REGEX "\\.c$")
add_custom_command(OUTPUT ${double_outputs} ${double_folder}/double_names.h ${double_folder}/double_system.h
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR}/src -DFOLDER=${double_folder} -P ${CMAKE_SOURCE_DIR}/cmake/double_sources.cmake
  DEPENDS ${double_from} ${double_folder}/list.txt ${CMAKE_SOURCE_DIR}/cmake/double_sources.cmake COMMENT "Rewriting the models for double precision" VERBATIM)
add_custom_target(steradian_double_sources DEPENDS ${double_headers})

add_library(steradian_double OBJECT ${double_compiled} src/lab/double/bridge.c)
add_dependencies(steradian_double steradian_double_sources)
# no warnings: what they would tell of, the first compilation has told of
target_compile_options(steradian_double PRIVATE -w -O2 -include ${CMAKE_SOURCE_DIR}/src/lab/double/prefix.h)
target_include_directories(steradian_double PRIVATE ${double_folder} ${CMAKE_SOURCE_DIR}/include ${CMAKE_SOURCE_DIR}/src)
target_link_libraries(steradian_double PRIVATE steradian_flags)
