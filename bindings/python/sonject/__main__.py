"""The command sonject: python3 -m sonject, or the program that pip puts on the PATH."""

import os
import pathlib
import subprocess
import sys


def main() -> None:
    """Runs the program beside this module in place of this process."""
    is_windows = sys.platform == "win32"
    program = pathlib.Path(__file__).resolve().with_name("sonject.exe" if is_windows else "sonject")
    try:
        if is_windows:  # a process there cannot become another
            sys.exit(subprocess.call([program, *sys.argv[1:]]))
        os.execv(program, ["sonject", *sys.argv[1:]])
    except OSError as error:
        sys.exit(
            f"sonject: {program} cannot be run: {error.strerror}: install the wheel of sonject, which has it"
        )


if __name__ == "__main__":
    main()
