# SPDX-License-Identifier: MIT
# For which processors is compiled (STERADIAN_ISA), and one shared library for each level of x86-64.
#
# The loader of glibc (2.33 and later) looks for a library in glibc-hwcaps/x86-64-v4, -v3 and -v2 of each folder first, as far as the
# processor goes, so nothing has to choose at run time. Vectors by value are passed otherwise at each level: whoever uses more than
# the public interface must be of the same level, so the command is a part of the library and its program calls it.
include(GNUInstallDirs)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set(STERADIAN_BASE_LEVEL x86-64-v2)
endif()
set(STERADIAN_LEVELS)
if(STERADIAN_ISA STREQUAL "levels")
  include(CheckCSourceCompiles)
  check_c_source_compiles("#include <features.h>\n#if !defined(__GLIBC__) || __GLIBC__ * 100 + __GLIBC_MINOR__ < 233\n#error\n#endif\nint main(void) { return 0; }" STERADIAN_HAS_HWCAPS)
  if(STERADIAN_BASE_LEVEL AND STERADIAN_HAS_HWCAPS)
    set(STERADIAN_LEVELS x86-64-v2 x86-64-v3 x86-64-v4)
    if(CMAKE_C_COMPILER_ID STREQUAL "GNU" AND CMAKE_C_COMPILER_VERSION VERSION_LESS 11)
      message(FATAL_ERROR "gcc ${CMAKE_C_COMPILER_VERSION} does not know the levels of x86-64: expected 11 or later")
    endif()
  else()
    message(STATUS "STERADIAN_ISA=levels: this system has but one level")
  endif()
endif()
set(march "")
if(STERADIAN_ISA MATCHES "^(baseline|levels)$")
  set(march ${STERADIAN_BASE_LEVEL})
elseif(STERADIAN_ISA)
  set(march ${STERADIAN_ISA})
endif()
set(STERADIAN_MARCH_OPTIONS)
if(march)
  check_c_compiler_flag(-march=${march} STERADIAN_HAS_MARCH_${march})
  if(STERADIAN_HAS_MARCH_${march})
    # a target's property STERADIAN_LEVEL goes before
    set(STERADIAN_MARCH_OPTIONS "-march=$<IF:$<BOOL:$<TARGET_PROPERTY:STERADIAN_LEVEL>>,$<TARGET_PROPERTY:STERADIAN_LEVEL>,${march}>")
  endif()
endif()

# libsteradian.so for each level, the tables that they share, and the command
function(steradian_add_levels)
  set(folder ${CMAKE_BINARY_DIR}/levels)
  add_library(steradian_tables SHARED ${RGB_TABLE_SOURCES})
  target_compile_definitions(steradian_tables PRIVATE SR_TABLES_APART)
  set_target_properties(steradian_tables PROPERTIES OUTPUT_NAME steradian_tables LINKER_LANGUAGE C LIBRARY_OUTPUT_DIRECTORY ${folder}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_source_files_properties(tools/steradian/main.c PROPERTIES COMPILE_OPTIONS "-Dmain=sr_command_main;-fvisibility=default")
  foreach(level ${STERADIAN_LEVELS})
    set(name steradian_${level})
    set(below /glibc-hwcaps/${level})
    if(level STREQUAL STERADIAN_BASE_LEVEL) # for all others too
      set(below "")
    endif()
    add_library(${name} SHARED ${STERADIAN_SOURCES} ${STERADIAN_TOOL} $<TARGET_OBJECTS:steradian_double>)
    set_target_properties(${name} PROPERTIES STERADIAN_LEVEL ${level} OUTPUT_NAME steradian EXPORT_NAME steradian C_VISIBILITY_PRESET hidden
      LIBRARY_OUTPUT_DIRECTORY ${folder}${below} INSTALL_RPATH "$ORIGIN;$ORIGIN/../.."
      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include> PRIVATE src ${EMBREE_INCLUDE_DIR})
    target_include_directories(${name} SYSTEM PRIVATE ${NANOVDB_INCLUDE_DIR})
    target_compile_definitions(${name} PRIVATE SR_VERSION="${PROJECT_VERSION}")
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:steradian_flags> steradian_tables Threads::Threads PNG::PNG JPEG::JPEG ZLIB::ZLIB EXPAT::EXPAT
      PkgConfig::OPENEXR PkgConfig::CAIRO PkgConfig::CMINPACK PkgConfig::JANSSON ${EMBREE_LIBRARY} m)
    target_link_options(${name} PRIVATE ${STERADIAN_LTO_LINK})
    list(APPEND names ${name})
  endforeach()
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/command.c CONTENT "int sr_command_main(int, char **);\nint main(int n, char **words)\n{\n    return sr_command_main(n, words);\n}\n")
  add_executable(steradian_command ${CMAKE_BINARY_DIR}/command.c)
  target_link_libraries(steradian_command PRIVATE steradian_${STERADIAN_BASE_LEVEL})
  set_target_properties(steradian_command PROPERTIES OUTPUT_NAME steradian INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  add_dependencies(steradian_command ${names}) # whichever the loader takes
  if(NOT BUILD_TESTING)
    set_target_properties(steradian PROPERTIES EXCLUDE_FROM_ALL TRUE)
  endif()
endfunction()
