#!/bin/bash
# A sweep on a Dask cluster: bash examples/sweeps/dask.sh examples/sweeps/thousand.yaml
#
# Here scheduler and workers are started on this machine. On a cluster, they are started by dask-jobqueue, dask-mpi or the
# site's own means; each worker is one process of one thread in coilset's environment, and sees the sweep's files.

set -euo pipefail
sweep=${1:?give the file of the sweep}
shift
address=tcp://127.0.0.1:${DASK_PORT:-8786}

scripts/coilset python -m distributed.cli.dask_scheduler --host 127.0.0.1 --port "${DASK_PORT:-8786}" --no-dashboard &
scheduler=$!
scripts/coilset python -m distributed.cli.dask_worker "$address" --nworkers 2 --nthreads 1 --no-dashboard &
workers=$!
trap 'kill $workers $scheduler' EXIT

scripts/coilset sweep "$sweep" --engine dask --scheduler "$address" "$@"
