# SPDX-License-Identifier: MIT
# Fuzz targets: cmake -DSTERADIAN_FUZZ=ON, target fuzz_programs. Readers are compiled anew, with sanitizers; with clang's
# libFuzzer where the compiler has it, else with a driver of our own. `make fuzz SECONDS=60` does all of it.
set(fuzzed_sources ${STERADIAN_SOURCES})
list(FILTER fuzzed_sources EXCLUDE REGEX "/src/(lab|plot|study|glare|api)/") # these read nothing
set(fuzz_flags -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
set(CMAKE_REQUIRED_FLAGS -fsanitize=fuzzer-no-link)
check_c_source_compiles("int main(void) { return 0; }" STERADIAN_HAS_LIBFUZZER)
unset(CMAKE_REQUIRED_FLAGS)

add_library(steradian_fuzzed STATIC EXCLUDE_FROM_ALL ${fuzzed_sources} ${RGB_TABLE_SOURCES})
target_include_directories(steradian_fuzzed PUBLIC src include tests ${EMBREE_INCLUDE_DIR})
target_include_directories(steradian_fuzzed SYSTEM PRIVATE ${NANOVDB_INCLUDE_DIR})
target_compile_options(steradian_fuzzed PUBLIC ${fuzz_flags})
target_link_options(steradian_fuzzed PUBLIC -fsanitize=address,undefined)
target_link_libraries(steradian_fuzzed PUBLIC steradian_flags Threads::Threads ZLIB::ZLIB EXPAT::EXPAT PNG::PNG JPEG::JPEG PkgConfig::OPENEXR
  PkgConfig::JANSSON PkgConfig::CMINPACK ${EMBREE_LIBRARY} m)
target_compile_definitions(steradian_fuzzed PRIVATE SR_VERSION="${PROJECT_VERSION}")
if(STERADIAN_HAS_LIBFUZZER)
  target_compile_options(steradian_fuzzed PUBLIC -fsanitize=fuzzer-no-link)
endif()

add_custom_target(fuzz_programs)

# one program for each format of a source, numbered in the order of its seeds
function(fuzz_formats source formats)
  set(number 0)
  foreach(format ${formats})
    add_executable(fuzz_${format} EXCLUDE_FROM_ALL tests/fuzz/${source})
    target_link_libraries(fuzz_${format} PRIVATE steradian_fuzzed)
    target_compile_definitions(fuzz_${format} PRIVATE FUZZ_SEED=${number})
    if(STERADIAN_HAS_LIBFUZZER)
      target_compile_definitions(fuzz_${format} PRIVATE FUZZ_LIBFUZZER)
      target_link_options(fuzz_${format} PRIVATE -fsanitize=fuzzer)
    endif()
    set_target_properties(fuzz_${format} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/fuzz)
    add_dependencies(fuzz_programs fuzz_${format})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()

fuzz_formats(fuzz_measured.c "merl;rgl;rgl_rgb;polarised;klems;tree;cornell;astm;abg;table;cloud")
fuzz_formats(fuzz_photometry.c "ies;ies_b;ldt")
fuzz_formats(fuzz_nanovdb.c "nanovdb")
fuzz_formats(fuzz_gltf.c "gltf;glb")
fuzz_formats(fuzz_mesh.c "obj;stl_text;stl_binary")
fuzz_formats(fuzz_scene.c "pbrt;scene;tables;ply")
fuzz_formats(fuzz_store.c "store")
fuzz_formats(fuzz_image.c "exr;png;jpeg;pfm;hdr;qoi;tga")
