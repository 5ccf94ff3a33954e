#!/bin/bash
# A sweep over the nodes of a cluster: sbatch examples/sweeps/slurm.sh examples/sweeps/thousand.yaml
#
# Rank 0 leads, the others solve one case each: 2 · 64 ranks run 127 cases at a time. Sent again it does what is missing,
# also after the time was too short: --resume runs everything where nothing is there yet. Behind the sweep's file may
# stand more options, such as --ranks-per-case 4 for springs of very many elements.

#SBATCH --job-name=coilset
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=64
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=04:00:00
#SBATCH --signal=TERM@120
#SBATCH --output=%x-%j.log

set -euo pipefail
sweep=${1:?give the file of the sweep}
shift
cd "${SLURM_SUBMIT_DIR:?to be started by sbatch, from the folder of coilset}"

# Once, before all ranks start: finds the environment, compiles forms and kernels into the cache in the home folder.
srun --nodes=1 --ntasks=1 scripts/coilset solve examples/ck15_presetting.yaml --no-pictures --overwrite \
    --out "results/warm-$SLURM_JOB_ID"

# MPI of the environment must know SLURM's process manager (srun --mpi=list shows which there are).
srun --mpi=pmix scripts/coilset sweep "$sweep" --resume "$@"
