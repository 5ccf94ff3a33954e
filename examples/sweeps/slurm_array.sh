#!/bin/bash
# A sweep as a job array: sbatch examples/sweeps/slurm_array.sh examples/sweeps/thousand.yaml
#
# Each task of the array runs a shard of the cases, on its own cores and with a journal of its own in the sweep's folder;
# tasks may start and end at any time. Sent again, each runs what its shard still lacks. When all have ended:
#
#   scripts/coilset sweep examples/sweeps/thousand.yaml --collect

#SBATCH --job-name=coilset
#SBATCH --array=1-100
#SBATCH --cpus-per-task=16
#SBATCH --mem-per-cpu=1G
#SBATCH --time=04:00:00
#SBATCH --output=%x-%A-%a.log

set -euo pipefail
sweep=${1:?give the file of the sweep}
shift
cd "${SLURM_SUBMIT_DIR:?to be started by sbatch, from the folder of coilset}"

# Ten minutes before the end of the job no case is started that would not end by then.
scripts/coilset sweep "$sweep" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --jobs "$SLURM_CPUS_PER_TASK" \
    --until 3:50:00 "$@"
