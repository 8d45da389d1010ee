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

# Slurm also takes a task for ended that is about to be requeued: then this job goes back, too. A task
# has ended when squeue gives it one of these states, or has forgotten it. Anything else, such as no
# answer from a busy controller, says that it may go on.
tasks=$(echo "${SLURM_JOB_DEPENDENCY#afterany:}" | tr : ,)
ended='BOOT_FAIL|CANCELLED|COMPLETED|DEADLINE|FAILED|NODE_FAIL|OUT_OF_MEMORY|PREEMPTED|TIMEOUT'
if [ -n "$tasks" ] && squeue --noheader --states=all --format=%T --jobs="$tasks" 2>&1 |
    grep -qvxE "$ended|.*Invalid job id.*"; then
    echo "merge.sh: job $tasks may not have ended, and so the merge is put back into the queue" >&2
    exec scontrol requeue "$SLURM_JOB_ID"
fi

sonject merge "$@"
exit $?
