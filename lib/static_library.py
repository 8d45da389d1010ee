"""Makes the static library: static_library.py OUTPUT OBJCOPY AR ARCHIVE... -- COMPILER...

All archives become one object file, in which only the names of the interface stay global. Other names,
and those of C++, cannot clash with names of a program that links the library.
"""

import pathlib
import subprocess
import sys
import tempfile


def main():
    output, objcopy, ar, *archives = sys.argv[1:]
    end = archives.index("--")
    archives, compiler = archives[:end], archives[end + 1:]
    made = pathlib.Path(output)
    made.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(dir=made.resolve().parent) as folder:
        whole = pathlib.Path(folder) / "sonject.o"
        # Linkers merge section groups with those of other files, and could drop names that are local here.
        subprocess.run([*compiler, "-r", "-nostdlib", "-Wl,--force-group-allocation",
                        "-Wl,--whole-archive", *archives, "-o", whole], check=True)
        subprocess.run([objcopy, "--localize-hidden", "--wildcard", "--keep-global-symbol=sonject_*",
                        whole], check=True)
        subprocess.run([ar, "rcsD", output, whole], check=True)


if __name__ == "__main__":
    main()
