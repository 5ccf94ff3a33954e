"""`python -m coilset.scripts`."""

from coilset.scripts.main import run

run()
