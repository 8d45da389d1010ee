"""Tests that each room, a folder of lib, calls only the rooms below it, as the linker sees it."""
import os
import pathlib
import re
import subprocess

LIB = pathlib.Path(os.environ["SONJECT_SOURCE"]) / "lib"
ARCHIVE = pathlib.Path(os.environ["SONJECT_LIBRARY"]).parent / "libsonject_internal.a"

ROOMS = ["api", "dataset", "inject", "measure", "elements", "form", "trace", "schema", "swath",
         "scene", "mesh", "medium", "image", "device", "base"]  # each may call the rooms after it


def symbols_of_rooms():
    """Returns the symbols that the rooms define, and (room, symbol) for each symbol that a room
    needs. Objects of no room are skipped: the build makes them, such as the kernels' text."""
    defined, wanted = {}, []
    listing = subprocess.run(["nm", "--print-file-name", ARCHIVE], check=True, capture_output=True,
                             text=True).stdout
    for line in listing.splitlines():
        place, words = line.rsplit(":", 1)
        room = re.search(r"([a-z-]+)_[^/:]*$", place)[1]
        kind, symbol = words.split()[-2:]
        if room in ROOMS and kind == "U":
            wanted.append((room, symbol))
        elif room in ROOMS and kind.isupper():
            defined[symbol] = room
    return defined, wanted


def test_every_folder_is_a_room():
    assert sorted(path.name for path in LIB.iterdir() if path.is_dir()) == sorted(ROOMS)


def test_no_room_calls_one_above_it():
    defined, wanted = symbols_of_rooms()
    assert set(defined.values()) == set(ROOMS)
    upwards = {f"{room} calls {symbol} of {defined[symbol]}" for room, symbol in wanted
               if symbol in defined and ROOMS.index(defined[symbol]) < ROOMS.index(room)}
    assert not upwards


def test_one_folder_knows_the_operating_system():
    """Searches for macros of a system and headers beyond C's. export.h may ask for Windows' exports."""
    names = r"_(POSIX|XOPEN|GNU|BSD|DEFAULT)_[A-Z_]*SOURCE|_WIN(32|64)|__(linux|unix|APPLE)|" \
            r"<(unistd|fcntl|dirent|dlfcn|poll|sched|spawn|windows|io|sys/\w+)\.h>"
    found = {str(path.relative_to(LIB.parent)) for folder in ("lib", "tools", "include", "kernels")
             for path in (LIB.parent / folder).rglob("*.[ch]")
             if re.search(names, path.read_text(encoding="utf-8"))}
    assert {name for name in found if not name.startswith("lib/base/system/")} == {
        "include/sonject/export.h"}
