"""Makes a Python for Windows that Wine can run, of packages from Debian and PyPI alone.

panda3d's wheel for Windows brings the interpreter's library and its modules in C. The modules in Python
are this machine's own, of the same minor version. Where both meet is a program of one call."""
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import zipfile

MINOR = "{}.{}".format(*sys.version_info)
LIBRARY = "python{}{}.dll".format(*sys.version_info)
PROGRAM = f"""
#include <windows.h>

int wmain(int count, wchar_t **words)
{{
    HMODULE library = LoadLibraryW(L"{LIBRARY}");
    return ((int (*)(int, wchar_t **))(void *)GetProcAddress(library, "Py_Main"))(count, words);
}}
"""
ELSEWHERE = shutil.ignore_patterns("__pycache__", "config-*", "dist-packages", "lib-dynload", "site-packages", "test")


def pip(*words):
    subprocess.run([sys.executable, "-m", "pip", "-q", *words, "--platform", "win_amd64", "--python-version", MINOR,
                    "--only-binary=:all:"], check=True)


def make(folder, zig, packages):
    """Makes it in a new folder with packages and returns its program. zig is the compiler's path."""
    shutil.copytree(sysconfig.get_path("stdlib"), folder / "Lib", ignore=ELSEWHERE)
    pip("download", "--no-deps", "-d", folder, "panda3d")
    (wheel,) = folder.glob("panda3d*.whl")
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            path = pathlib.PurePosixPath(name)
            if str(path.parent) == "deploy_libs":
                place = folder if path.suffix == ".dll" else folder / "DLLs"
                place.mkdir(exist_ok=True)
                (place / path.name).write_bytes(archive.read(name))
    pip("install", "--target", folder / "Lib" / "site-packages", *packages)
    (folder / "python.c").write_text(PROGRAM, encoding="utf-8")
    program = folder / "python.exe"
    subprocess.run([zig, "cc", "-target", "x86_64-windows-gnu", "-municode", "-o", program, folder / "python.c"], check=True)
    return program
