#!/bin/bash
# A sweep on a Dask cluster: bash examples/sweeps/dask.sh examples/sweeps/thousand.yaml
#
# Here scheduler and workers are started on this machine. On a cluster, they are started by dask-jobqueue, dask-mpi or the
# site's own means; each worker is one process of one thread in coilset's environment, and sees the sweep's files.
#
# Whoever reaches a scheduler can have it run code. So all three take part by a key that is made for this sweep; on a
# cluster of your own, keep key and certificate in a folder that only you can read.

set -euo pipefail
sweep=${1:?give the file of the sweep}
shift
address=tls://127.0.0.1:${DASK_PORT:-8786}

keys=$(mktemp -d)
trap 'rm -r "$keys"' EXIT
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 30 -subj /CN=coilset \
    -keyout "$keys/key" -out "$keys/certificate" 2> /dev/null
export DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION=True DASK_DISTRIBUTED__COMM__TLS__CA_FILE=$keys/certificate
for role in CLIENT SCHEDULER WORKER; do
    export "DASK_DISTRIBUTED__COMM__TLS__${role}__KEY=$keys/key" "DASK_DISTRIBUTED__COMM__TLS__${role}__CERT=$keys/certificate"
done

scripts/coilset python -m distributed.cli.dask_scheduler --protocol tls --host 127.0.0.1 --port "${DASK_PORT:-8786}" \
    --no-dashboard &
scheduler=$!
scripts/coilset python -m distributed.cli.dask_worker "$address" --nworkers 2 --nthreads 1 --no-dashboard &
workers=$!
trap 'kill $workers $scheduler; rm -r "$keys"' EXIT

scripts/coilset sweep "$sweep" --engine dask --scheduler "$address" "$@"
