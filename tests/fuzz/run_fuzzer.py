"""Runs a fuzzer on a corpus of its kind: run_fuzzer.py PROGRAM KIND SOURCE.

SONJECT_FUZZ_SECONDS is the duration, s (60 or 20 by kind). SONJECT_FUZZ_FINDINGS is the folder for
findings (./findings). All runs begin with the same seed.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

import corpora

# A pyramid of four triangles in place of a rock's hundreds.
ROCK = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
# Kinds that run for 60 s: the readers of the files that scenes are made of.
MINUTE = {"scene", "xtf", "jsf", "npy", "stl", "obj", "ply"}
LONGEST = {"scene": 8192, "target": 8192, "xtf": 4096, "jsf": 4096}


def fill(folder, kind, source):
    """Fills the fuzzer's folder. Returns the arguments that name its dictionary."""
    corpora.make(kind, folder / "corpus", source)
    (folder / "scenes").mkdir()
    (folder / "targets").mkdir()
    for name, text in corpora.targets(source).items():
        (folder / "targets" / name).write_bytes(text)
    (folder / "targets" / "rock.obj").write_bytes(ROCK)
    image = corpora.arrays(source)["f4"]
    (folder / "a.npy").write_bytes(image)
    for labels in ("yolo", "voc"):
        (folder / labels).mkdir()
        (folder / labels / "a.npy").write_bytes(image)
    words = corpora.words(kind, source)
    (folder / "words").write_text("".join(f'"{word}"\n' for word in words))
    return [f"-dict={folder / 'words'}"] if words else []


def main():
    program, source = (pathlib.Path(sys.argv[i]).resolve() for i in (1, 3))
    kind = sys.argv[2]
    seconds = os.environ.get("SONJECT_FUZZ_SECONDS", "60" if kind in MINUTE else "20")
    findings = pathlib.Path(os.environ.get("SONJECT_FUZZ_FINDINGS", "findings")).absolute()
    findings.mkdir(parents=True, exist_ok=True)
    fast = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="sonject-fuzz-", dir=fast) as name:
        folder = pathlib.Path(name)
        dictionary = fill(folder, kind, source)
        arguments = [
            program, "-seed=1", f"-max_total_time={seconds}", f"-max_len={LONGEST.get(kind, 2048)}",
            "-timeout=60", "-rss_limit_mb=2048", "-print_final_stats=1", "-verbosity=0",
            f"-artifact_prefix={findings / kind}-", *dictionary, folder / "corpus",
        ]
        ended = subprocess.run(arguments, cwd=folder, stdin=subprocess.DEVNULL, check=False)
        # libFuzzer exits with 77 after a finding, but Meson takes 77 for a skipped test.
        return 1 if ended.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
