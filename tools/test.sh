#!/bin/sh
# Installs what is needed, builds and runs all tests but those that .ci/nightly runs. Arguments go to
# meson test, SONJECT_SETUP to meson setup.
set -eu
cd "$(dirname "$0")/.."
. tools/setup.sh

# shellcheck disable=SC2086 # lists of words
install_packages $build_packages $test_packages
# shellcheck disable=SC2086 # a list of words
build_release -Dtests=enabled ${SONJECT_SETUP:-}
install_readers
meson test -C build --print-errorlogs "$@"
