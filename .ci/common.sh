# What the gate and the nightly run share; to be sourced by bash from the project's top folder.
# shellcheck shell=bash disable=SC2034

# The OpenCL driver keeps memory until the process ends.
export LSAN_OPTIONS="suppressions=$PWD/.ci/leaks:print_suppressions=0"
# The leak checker dies, now and then, when it reads the thread storage of what the driver's compiler
# has left behind.
export ASAN_OPTIONS="intercept_tls_get_addr=0"
export SONJECT_READERS="$PWD/build/readers/bin/python"

# Tests write and sync thousands of small files: in memory, where there is enough.
if [ "$(df --output=avail /dev/shm 2>/dev/null | tail -n 1)" -gt 4000000 ] 2>/dev/null; then
    TMPDIR=$(mktemp -d /dev/shm/sonject.XXXXXX)
    export TMPDIR
    trap 'rm -rf "$TMPDIR"' EXIT
fi

logs=()

# make_build FOLDER PROGRAMS OPTION...: a new folder with the programs in the folders that match.
make_build() {
    local folder=$1 programs=$2
    shift 2
    rm -rf "$folder"
    # shellcheck disable=SC2046 # a list of names
    meson setup "$folder" -Dtests=enabled "$@" &&
        ninja -C "$folder" $(ninja -C "$folder" -t targets all |
            sed -nE "s#^(($programs)/[^:]*): [a-z]+_LINKER.*#\\1#p")
}

# run_tests FOLDER ARGUMENT...: runs what is built there; its log is counted.
run_tests() {
    local folder=$1
    shift
    meson test -C "$folder" --no-rebuild --print-errorlogs "$@"
}
