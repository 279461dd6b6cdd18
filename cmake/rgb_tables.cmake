# SPDX-License-Identifier: MIT
# Fits the RGB-to-spectrum tables while building (a few seconds, two threads) and embeds them by the assembler.
add_executable(steradian_fit_rgb src/spectrum/fit/fit_rgb.c src/spectrum/data_observer.c src/spectrum/data_illuminants.c
  src/spectrum/data_colour_spaces.c)
target_include_directories(steradian_fit_rgb PRIVATE ${CMAKE_SOURCE_DIR}/include src)
target_compile_options(steradian_fit_rgb PRIVATE -O3 -Wall -Wextra -fno-math-errno -fno-trapping-math)
if(STERADIAN_HAS_NO_PSABI)
  target_compile_options(steradian_fit_rgb PRIVATE -Wno-psabi)
endif()
target_compile_options(steradian_fit_rgb PRIVATE ${STERADIAN_MARCH_OPTIONS})
target_link_libraries(steradian_fit_rgb PRIVATE Threads::Threads m)

set(rgb_tables_folder ${CMAKE_CURRENT_BINARY_DIR}/rgb_tables)
file(MAKE_DIRECTORY ${rgb_tables_folder})
set(rgb_tables_binaries)
set(rgb_tables_assembly "/* SPDX-License-Identifier: MIT */\n/* Embeds the tables that fit_rgb writes; made by cmake/rgb_tables.cmake. */\n\
#if defined(__APPLE__)\n#define SYMBOL(name) _##name\n#define INTERNAL(name) .private_extern _##name\n.section __TEXT,__const\n\
#else\n#define SYMBOL(name) name\n#if defined(SR_TABLES_APART)\n#define INTERNAL(name)\n#else\n#define INTERNAL(name) .hidden name\n#endif\n.section .rodata.rgb_tables,\"a\"\n#endif\n")
foreach(space srgb dci_p3 rec2020 aces2065_1)
  list(APPEND rgb_tables_binaries ${rgb_tables_folder}/${space}.bin)
  string(APPEND rgb_tables_assembly "\n.globl SYMBOL(sr_rgb_table_${space})\nINTERNAL(sr_rgb_table_${space})\n.p2align 6\nSYMBOL(sr_rgb_table_${space}):\n\
.incbin \"${rgb_tables_folder}/${space}.bin\"\n#if defined(__ELF__)\n.type sr_rgb_table_${space}, %object\n.size sr_rgb_table_${space}, . - sr_rgb_table_${space}\n#endif\n")
endforeach()
string(APPEND rgb_tables_assembly "\n#if defined(__ELF__)\n.section .note.GNU-stack,\"\"\n#endif\n")
file(CONFIGURE OUTPUT ${rgb_tables_folder}/rgb_tables.S CONTENT "${rgb_tables_assembly}" @ONLY)

add_custom_command(OUTPUT ${rgb_tables_binaries} COMMAND steradian_fit_rgb ${rgb_tables_binaries}
  DEPENDS steradian_fit_rgb COMMENT "Fitting spectra to RGB" VERBATIM)
set_source_files_properties(${rgb_tables_folder}/rgb_tables.S PROPERTIES LANGUAGE ASM OBJECT_DEPENDS "${rgb_tables_binaries}")
set(RGB_TABLE_SOURCES ${rgb_tables_folder}/rgb_tables.S)
