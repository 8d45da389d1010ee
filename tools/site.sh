#!/bin/sh
# Makes a site of all pages, with the reference of the C and C++ interfaces, in build/site. Dead links fail.
set -eu
cd "$(dirname "$0")/.."
. tools/setup.sh

install_packages doxygen python3-venv
rm -rf build/site-pages build/site
mkdir -p build/site-pages build/reference
find README.md CONTRIBUTING.md CHANGELOG.md docs kernels tools bindings -type f \
    \( -name '*.md' -o -name '*.png' -o -name '*.yaml' -o -name '*.sh' -o -name '*.py' -o -name '*.ipynb' \) -print0 |
    tar -c --null -T - | tar -x -C build/site-pages
doxygen include/Doxyfile
cp -r build/reference/html build/site-pages/reference
[ -x build/site-env/bin/mkdocs ] || { python3 -m venv build/site-env &&
    build/site-env/bin/pip -q --disable-pip-version-check install mkdocs==1.6.1; }
build/site-env/bin/mkdocs build --strict -f docs/mkdocs.yml
echo "$(pwd)/build/site/index.html"
