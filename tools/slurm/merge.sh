#!/bin/sh
# Joins what the tasks of shards.sh left in DIR; names what is missing, and fails then:
#
#     sbatch --dependency=afterany:JOB tools/slurm/merge.sh DIR [OPTION ...]
#
# afterany, since afterok may never be met once a task was requeued.
#SBATCH --job-name=sonject-merge
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append

# Slurm also takes a task for ended that is about to be requeued: then this job goes back, too.
tasks=$(echo "${SLURM_JOB_DEPENDENCY#afterany:}" | tr : ,)
if [ -n "$tasks" ] && [ -n "$(squeue --noheader --jobs="$tasks" 2>/dev/null)" ]; then
    echo "merge.sh: job $tasks is still in the queue, and so the merge is put back into it" >&2
    exec scontrol requeue "$SLURM_JOB_ID"
fi

sonject merge "$@"
exit $?
