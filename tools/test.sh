#!/bin/sh
# Installs what is needed, builds and runs all tests. Arguments go to meson test.
set -eu
cd "$(dirname "$0")/.."
. tools/setup.sh

# shellcheck disable=SC2086 # lists of words
install_packages $build_packages $test_packages
build_release -Dtests=enabled
install_readers
meson test -C build --print-errorlogs "$@"
