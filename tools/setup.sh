# What first-run.sh and test.sh share: the Debian 12 packages that sonject needs, and the build.
# To be sourced from the project's top folder.
# shellcheck shell=sh disable=SC2034

build_packages="build-essential clang meson ninja-build pkg-config python3
    libpng-dev libtiff-dev libjpeg62-turbo-dev libhdf5-dev zlib1g-dev libyaml-dev libjansson-dev
    libexpat1-dev libxxhash-dev opencl-headers"
test_packages="pocl-opencl-icd ocl-icd-opencl-dev git cmake doxygen groff-base libcmocka-dev python3-numpy python3-pytest
    python3-h5py python3-pil python3-scipy python3-venv python3-yaml locales codespell hunspell hunspell-en-gb"
# From PyPI: readers by others, which tests hold our files to, and what builds, checks and draws with
# the Python package.
readers="pyxtf pingverter pycocotools meson-python mypy==1.18.2 matplotlib"

# dpkg calls programs from here, which a plain su leaves out.
PATH="$PATH:/usr/sbin:/sbin"
export PATH

is_installed() {
    # One line for each architecture that has it.
    dpkg-query -W -f='${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed
}

run_as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        echo "$0: root or sudo is needed to run: $*" >&2
        return 1
    fi
}

apt() {
    run_as_root env DEBIAN_FRONTEND=noninteractive apt-get -y -q \
        -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3 "$@"
}

# Calls a command within which installed packages start no services: nothing here needs any, and
# outside of a booted system they may not start. Where the machine has a policy, that stands.
without_services() {
    policy=/usr/sbin/policy-rc.d
    if [ -e "$policy" ]; then
        "$@"
        return
    fi
    (
        trap 'run_as_root rm -f "$policy"' EXIT
        trap 'exit 130' INT TERM HUP
        printf '#!/bin/sh\nexit 101\n' | run_as_root tee "$policy" >/dev/null &&
            run_as_root chmod 755 "$policy" && "$@"
    )
}

# Installs those of the named packages that are missing.
install_packages() {
    if ! command -v apt-get >/dev/null; then
        echo "$0: no apt-get here: install what corresponds to these Debian packages: $*" >&2
        return 0
    fi
    missing=
    for package in "$@"; do
        is_installed "$package" || missing="$missing $package"
    done
    [ -n "$missing" ] || return 0
    apt update
    # shellcheck disable=SC2086 # a list of words
    without_services apt install --no-install-recommends $missing
}

# Builds into ./build; a folder that an earlier call left, finished or not, is used again. Arguments
# go to meson setup.
build_release() {
    if [ -f build/meson-private/coredata.dat ]; then
        meson setup --reconfigure build --buildtype=release "$@" ||
            meson setup --wipe build --buildtype=release "$@"
    else
        meson setup build --buildtype=release "$@"
    fi
    ninja -C build
}

# Puts others' readers into build/readers, apart from the system's Python, and names that Python in
# SONJECT_READERS; says so where PyPI cannot be reached, and their tests are skipped.
install_readers() {
    # shellcheck disable=SC2086 # a list of words
    if python3 -m venv build/readers && build/readers/bin/pip -q --disable-pip-version-check \
        install $readers; then
        SONJECT_READERS="$(pwd)/build/readers/bin/python"
        export SONJECT_READERS
    else
        echo "$0: PyPI cannot be reached: tests with $readers are skipped" >&2
    fi
}
