#!/bin/sh
# From a bare Debian 12 to a first picture: installs what is needed, builds, runs the demo.
# Its last line is the path of the picture. Can be run again at any time.
set -eu
cd "$(dirname "$0")/.."
. tools/setup.sh

# shellcheck disable=SC2086 # a list of words
install_packages $build_packages
build_release -Dtests=disabled
build/tools/sonject run tools/scenes/demo.yaml -o build/demo --overwrite
echo "$(pwd)/build/demo/quicklook.png"
