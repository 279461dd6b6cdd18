#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the build into a fresh prefix, then builds and runs a stranger's program against it: as C and as C++, by pkg-config
# and by CMake.
#
# Usage: install.sh SOURCE_DIR BUILD_DIR CC CXX CMAKE SHARED FLAGS
set -eu
source_dir=$1 build_dir=$2 cc=$3 cxx=$4 cmake=$5 shared=$6 flags=$7
scene=$source_dir/scenes/cornell-box.pbrt
consumer=$source_dir/tests/api/consumer
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
prefix=$folder/prefix

"$cmake" --install "$build_dir" --prefix "$prefix" >"$folder/install.log"
for file in bin/steradian include/steradian/steradian.h; do
    [ -f "$prefix/$file" ] || { echo "failed: $file is not installed" >&2; exit 1; }
done
grep -rlwF -e "$build_dir" -e "$source_dir" "$prefix/include" "$prefix"/lib*/cmake "$prefix"/lib*/pkgconfig 2>/dev/null && {
    echo "failed: installed files tell where they were built" >&2
    exit 1
}
"$prefix/bin/steradian" --version

pc=$(find "$prefix" -name steradian.pc)
PKG_CONFIG_PATH=$(dirname "$pc")
export PKG_CONFIG_PATH
static=--static
eval "libdir=$(pkg-config --variable=libdir steradian)" # escaped for a shell
if [ "$shared" = ON ]; then
    static=
    # nothing but the public interface is seen from outside; of libraries by level the command is a part, which its program calls
    [ -d "$libdir/glibc-hwcaps" ] || seen=$(nm -D --defined-only "$libdir/libsteradian.so" | awk '{print $3}' | grep -v '^sr_\(version\|world\|picture\|reading\|brdf\)' || true)
    [ -z "${seen:-}" ] || { echo "failed: the shared library shows $seen" >&2; exit 1; }
fi
export LD_LIBRARY_PATH="$libdir"
if [ "$shared" = OFF ] && command -v objdump >/dev/null && objdump -h "$libdir/libsteradian.a" | grep -q '\.gnu\.lto_'; then
    echo "failed: whoever links the library optimises all of it again" >&2
    exit 1
fi

# the command that is told, with what pkg-config tells, which escapes blanks in paths for a shell
with_package() {
    # shellcheck disable=SC2086 # a list of words
    eval "set -- \"\$@\" $(pkg-config --cflags --libs $static steradian) -lm"
    "$@"
}
cp "$consumer/consumer.c" "$folder/consumer.cpp"
echo "== pkg-config, C"
# shellcheck disable=SC2086 # a list of words
with_package "$cc" -std=c17 -Wall -Wextra -Wpedantic -Wconversion -Werror $flags -o "$folder/consumer_c" "$consumer/consumer.c"
"$folder/consumer_c" "$scene"
# shellcheck disable=SC2086
with_package "$cc" -std=c17 -Wall -Wextra -Wpedantic -Wconversion -Werror $flags -o "$folder/brdf" "$source_dir/examples/brdf.c"
"$folder/brdf"
echo "== pkg-config, C++"
# shellcheck disable=SC2086
with_package "$cxx" -std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Werror $flags -o "$folder/consumer_cxx" "$folder/consumer.cpp"
"$folder/consumer_cxx" "$scene"

echo "== CMake, C and C++"
"$cmake" -S "$consumer" -B "$folder/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" >"$folder/configure.log"
"$cmake" --build "$folder/build" >"$folder/build.log"
"$folder/build/consumer_c" "$scene"
"$folder/build/consumer_cxx" "$scene"
