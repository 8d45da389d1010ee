"""Checks the sources that a build folder has not built for warnings: compile_rest.py FOLDER

Takes each source's command from compile_commands.json and generates no code. Slow tests are checked
in a fraction of their build's time. Exits with 1 if the compiler rejects a source.
"""

import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys


def left_out(folder):
    """Returns (folder, command) of each source without an object file. A shared source appears once."""
    commands = {}
    for entry in json.loads((folder / "compile_commands.json").read_text(encoding="utf-8")):
        directory = pathlib.Path(entry["directory"])
        command = shlex.split(entry["command"])
        # programs that share a source differ only in paths in PROGRAM.p
        key = tuple(word for word in command
                    if not word.endswith(".p") and ".p/" not in word)
        if not (directory / entry["output"]).exists():
            commands.setdefault(key, (directory, command))
    return commands.values()


def check(directory, command):
    """Returns whether the compiler accepts the source, and the compiler's output."""
    checked = subprocess.run([*command, "-fsyntax-only"], cwd=directory, check=False,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return checked.returncode == 0, checked.stdout


def main():
    sources = list(left_out(pathlib.Path(sys.argv[1])))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda source: check(*source), sources))
    for is_clean, said in results:
        if not is_clean:
            print(said)
    print(f"{len(sources)} sources compiled for warnings alone, "
          f"{sum(not is_clean for is_clean, _ in results)} with some")
    return 0 if all(is_clean for is_clean, _ in results) else 1


if __name__ == "__main__":
    sys.exit(main())
