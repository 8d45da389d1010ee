#!/bin/sh
# Makes what a release consists of, from a tag: release.sh TAG [MACHINE...|none]. In
# build-release/sonject-VERSION then lie the sources, a wheel for each MACHINE of tools/wheels.sh (all
# of them unless some are named), and SHA256SUMS.
#
# The tag is vVERSION. Its meson.build must say that version, and its CHANGELOG.md have a section
# "## VERSION (YYYY-MM-DD)". Wheels are built from the archive, so nothing else can get into them.
set -eu
cd "$(dirname "$0")/.."

refuse() {
    echo "$0: $*" >&2
    exit 1
}

[ $# -gt 0 ] || refuse "which tag? release.sh TAG [MACHINE...|none]"
tag=$1
shift
version=${tag#v}
git rev-parse -q --verify "refs/tags/$tag" >/dev/null || refuse "there is no tag $tag"
[ -z "$(git status --porcelain)" ] || refuse "the tree has changes that are not committed"
said=$(git show "$tag:meson.build" | sed -n "s/^  version: '\(.*\)',$/\1/p")
[ "v$said" = "$tag" ] || refuse "$tag: meson.build says version $said: the tag must be v$said"
git show "$tag:CHANGELOG.md" | grep -qxE "## $version \([0-9]{4}-[0-9]{2}-[0-9]{2}\)" ||
    refuse "$tag: CHANGELOG.md has no section '## $version (YYYY-MM-DD)'"

SOURCE_DATE_EPOCH=$(git log -1 --format=%ct "$tag")
export SOURCE_DATE_EPOCH
name=sonject-$version
place=$(pwd)/build-release
rm -rf "$place"
mkdir -p "$place/$name"
git archive --format=tar --prefix="$name/" "$tag" | gzip -9n >"$place/$name/$name.tar.gz"
if [ "$*" != none ]; then
    mkdir "$place/work"
    tar -xzf "$place/$name/$name.tar.gz" -C "$place/work"
    sh "$place/work/$name/tools/wheels.sh" "$@"
    mv "$place/work/$name"/build-wheels/wheels/*.whl "$place/$name"
    rm -rf "$place/work"
fi
cd "$place/$name"
sha256sum -- * >"$place/SHA256SUMS"
mv "$place/SHA256SUMS" .
cat SHA256SUMS
echo "$place/$name"
