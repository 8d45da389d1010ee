"""Computes the parts of a run or of a campaign as tasks of Dask, and merges them:

    dask_shards.py SCHEDULER K run|campaign FILE.yaml -o DIR [OPTION ...]

SCHEDULER is the address that `dask scheduler` prints, K the number of parts. Start workers with
--nthreads 1. All workers must see this folder under the same path."""

import os
import subprocess
import sys

from distributed import Client, as_completed

STOPPED = 85
RETRIES = 3


def trace(command, folder):
    """Runs a part on a worker. Continues a part that was stopped. Raises with the message of one that fails."""
    code = STOPPED
    while code == STOPPED:
        answer = subprocess.run(command, cwd=folder, stderr=subprocess.PIPE, text=True, check=False)
        code = answer.returncode
    if code != 0:
        raise RuntimeError(f"{' '.join(command)}: exit code {code}: {answer.stderr.strip()}")


def main():
    if len(sys.argv) < 7 or "-o" not in sys.argv[5:-1]:
        sys.exit(__doc__)
    address, shards, arguments = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    folder = arguments[arguments.index("-o") + 1]
    commands = [
        ["sonject", *arguments, "--quiet", "--shard", f"{shard}/{shards}"]
        for shard in range(1, shards + 1)
    ]
    with Client(address) as client:
        # If a worker is lost, another one takes its part. With pure=False parts are computed each time.
        parts = client.map(trace, commands, folder=os.getcwd(), retries=RETRIES, pure=False)
        for part in as_completed(parts):
            part.result()
    sys.exit(subprocess.run(["sonject", "merge", folder], check=False).returncode)


if __name__ == "__main__":
    main()
