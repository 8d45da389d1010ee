"""The command sonject: python3 -m sonject, and what pip puts on the PATH."""

import os
import pathlib
import sys


def main() -> None:
    """Becomes the program beside this module."""
    program = pathlib.Path(__file__).resolve().with_name("sonject")
    try:
        os.execv(program, ["sonject", *sys.argv[1:]])
    except OSError as error:
        sys.exit(
            f"sonject: {program} cannot be run: {error.strerror}: install the wheel of sonject, which has it"
        )


if __name__ == "__main__":
    main()
