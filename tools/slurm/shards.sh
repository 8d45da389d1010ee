#!/bin/sh
# One part of a run or of a campaign, as a task of a job array:
#
#     sbatch --array=1-K tools/slurm/shards.sh K run SCENE.yaml -o DIR [OPTION ...]
#     sbatch --array=1-K tools/slurm/shards.sh K campaign CAMPAIGN.yaml -o DIR [OPTION ...]
#
# README.md beside it tells the rest.
#SBATCH --job-name=sonject
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append
# Two minutes before the time limit, to this shell alone, which hands it on as SIGTERM.
#SBATCH --signal=B:USR1@120

if [ $# -lt 4 ] || [ -z "$SLURM_ARRAY_TASK_ID" ]; then
    echo "usage: sbatch --array=1-K $0 K run|campaign FILE.yaml -o DIR [OPTION ...]" >&2
    exit 2
fi
shards=$1
shift

# Slurm signals this shell, or all its processes: SIGTERM may reach the renderer twice.
trap 'was_asked=yes; kill -s TERM "$!" 2>/dev/null' TERM USR1
sonject "$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" &

# A signal ends a wait, so it is begun again; 127: what is waited for had ended before. The code of
# a renderer that was killed is 128 + the signal's number; this shell does not die by the signal.
code=127
was_asked=yes
while [ -n "$was_asked" ]; do
    was_asked=
    wait "$!"
    answer=$?
    [ "$answer" -eq 127 ] || code=$answer
done
exit "$code"
