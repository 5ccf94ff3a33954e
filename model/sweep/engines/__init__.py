"""Where the cases of a sweep run: processes of this machine, ranks of an MPI job, workers of a Dask cluster."""
