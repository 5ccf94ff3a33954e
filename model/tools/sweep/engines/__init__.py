"""Where the cases of a sweep run: processes of this machine, ranks of an MPI job, workers of a Dask cluster.

Another engine is a function that makes a `pool.Pool`; `scripts/commands/sweep.py` chooses among them.
"""
