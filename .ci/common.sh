# Settings and functions of .ci/run and .ci/nightly. Bash sources this file in the project's top folder.
# shellcheck shell=bash disable=SC2034

# The OpenCL driver keeps memory until the process ends.
export LSAN_OPTIONS="suppressions=$PWD/.ci/leaks:print_suppressions=0"
# The leak checker sometimes crashes on thread storage that the driver's compiler has left behind.
# And LLVM, which the driver loads, gives threads a signal stack that the sanitizer would release.
export ASAN_OPTIONS="intercept_tls_get_addr=0:use_sigaltstack=0"
export SONJECT_READERS="$PWD/build/readers/bin/python"

# Tests write and sync thousands of small files. Temporary files lie in memory if over 4 GB are free.
if [ "$(df --output=avail /dev/shm 2>/dev/null | tail -n 1)" -gt 4000000 ] 2>/dev/null; then
    TMPDIR=$(mktemp -d /dev/shm/sonject.XXXXXX)
    export TMPDIR
    trap 'rm -rf "$TMPDIR"' EXIT
fi

logs=()

# make_build FOLDER PROGRAMS OPTION...: sets up a new build in FOLDER with meson's options. Builds the
# programs in all folders that match the regular expression PROGRAMS.
make_build() {
    local folder=$1 programs=$2
    shift 2
    rm -rf "$folder"
    # shellcheck disable=SC2046 # a list of names
    meson setup "$folder" -Dtests=enabled "$@" &&
        ninja -C "$folder" $(ninja -C "$folder" -t targets all |
            sed -nE "s#^(($programs)/[^:]*): [a-z]+_LINKER.*#\\1#p")
}

# run_tests FOLDER ARGUMENT...: runs the tests that are built in FOLDER.
run_tests() {
    local folder=$1
    shift
    meson test -C "$folder" --no-rebuild --print-errorlogs "$@"
}
