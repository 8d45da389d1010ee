#!/bin/sh
# Builds the fuzzers into ./build-fuzz by clang and runs each for SECONDS (default 60): fuzz.sh
# [SECONDS]. What makes one fail is kept in build-fuzz/tests/fuzz/findings.
set -eu
cd "$(dirname "$0")/.."

if [ ! -f build-fuzz/build.ninja ]; then
    CC=clang CXX=clang++ meson setup build-fuzz --buildtype=debugoptimized \
        -Db_sanitize=address,undefined -Db_lundef=false -Dfuzzers=true -Dtests=enabled \
        -Dhdf5=disabled
fi
# shellcheck disable=SC2046 # a list of names
ninja -C build-fuzz $(ninja -C build-fuzz -t targets all |
    sed -nE 's#^(tests/fuzz/[^:]*): [a-z]+_LINKER.*#\1#p')
SONJECT_FUZZ_SECONDS="${1:-60}" meson test -C build-fuzz --no-rebuild --print-errorlogs --suite fuzz
