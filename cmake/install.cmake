# SPDX-License-Identifier: MIT
# What `make install` puts under its prefix: command, library, public headers, and what pkg-config and CMake need to find them.
#
# The command and the tests look into the library, so they link the static one. BUILD_SHARED_LIBS=ON makes a shared
# library of the same objects and installs that; only what is marked SR_API can be seen from outside of it. STERADIAN_ISA=levels
# installs one for each level of x86-64 (levels.cmake).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set_target_properties(steradian steradian_double PROPERTIES C_VISIBILITY_PRESET hidden)
set(STERADIAN_INSTALLED steradian)
if(STERADIAN_LEVELS)
  set(BUILD_SHARED_LIBS ON) # as the package's users see it
  set(STERADIAN_INSTALLED steradian_${STERADIAN_BASE_LEVEL} steradian_tables)
  foreach(level ${STERADIAN_LEVELS})
    if(NOT level STREQUAL STERADIAN_BASE_LEVEL)
      install(TARGETS steradian_${level} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${level} NAMELINK_SKIP)
    endif()
  endforeach()
elseif(BUILD_SHARED_LIBS)
  add_library(steradian_shared SHARED $<TARGET_OBJECTS:steradian> $<TARGET_OBJECTS:steradian_double>)
  set_target_properties(steradian_shared PROPERTIES OUTPUT_NAME steradian EXPORT_NAME steradian LINKER_LANGUAGE C
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_include_directories(steradian_shared INTERFACE $<INSTALL_INTERFACE:include>)
  target_link_libraries(steradian_shared PRIVATE $<BUILD_INTERFACE:steradian_flags> Threads::Threads PNG::PNG JPEG::JPEG
    ZLIB::ZLIB EXPAT::EXPAT PkgConfig::OPENEXR PkgConfig::CAIRO PkgConfig::CMINPACK PkgConfig::JANSSON ${EMBREE_LIBRARY} m)
  set(STERADIAN_INSTALLED steradian_shared)
endif()

install(TARGETS ${STERADIAN_INSTALLED} EXPORT steradianTargets)
if(STERADIAN_LTO_COMPILE AND STERADIAN_INSTALLED STREQUAL "steradian" AND CMAKE_OBJCOPY AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  # an ordinary library: with gcc's own form in it, whoever links it would optimise all of it again, for half a minute
  install(CODE "
    execute_process(COMMAND \"${CMAKE_OBJCOPY}\" --wildcard --remove-section=.gnu.lto_* --remove-section=.gnu.debuglto_*
        \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:steradian>\" RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR \"libsteradian.a cannot be made an ordinary library\")
    endif()")
endif()
if(TARGET steradian_command)
  install(TARGETS steradian_command)
endif()
if(TARGET steradian_mpi)
  install(TARGETS steradian_mpi)
endif()
install(DIRECTORY include/steradian TYPE INCLUDE FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE TYPE DOC)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/steradian)
configure_package_config_file(cmake/steradianConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/steradianConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/steradianConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT steradianTargets NAMESPACE steradian:: DESTINATION ${package_folder})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/steradianConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/steradianConfigVersion.cmake
  DESTINATION ${package_folder})

# The prefix is told at the time of installing, so the .pc file finds it from where it lies itself.
file(RELATIVE_PATH STERADIAN_PC_TO_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/steradian.pc.in ${CMAKE_CURRENT_BINARY_DIR}/steradian.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/steradian.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
