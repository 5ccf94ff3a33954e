"""Comparisons with tables, closed solutions, finer meshes and the 3D model, each with its source and tolerance.

A case is a module `some_name.py` in a folder of `cases`, which `coilset verify some-name` finds by its name. It holds

- a docstring: the first line says what is compared with what; the rest, where the reference comes from, what the
  tolerance is based on, and what was found;
- `FAST = True` if it takes seconds: then the tests run it too and assert that it passes;
- `def run(study)`, which fills a `coilset.verification.study.Study`::

      study.check("maximum force, N", ours, 251.6, "Table 7.1", 0.01)                    # relative deviation up to 1 %
      study.check("rotation of the free end, rad", ours, 0.0, "symmetry", 1e-9, "absolute")
      study.check("iterations", ours, 6, "required", kind="at_most")
      study.shown("force, N", ours, 300.0, "Table 7.1", "out of balance in the source")   # in the table, not judged
      study.table("Table 7.1", ["u/l", "F ours", "F thesis"], rows)                       # printed and kept, not judged
      study.note("The last row is out of balance in the source itself.")
      study.figure("characteristic", figure)                                              # a matplotlib Figure, as PNG

Results go to `results/verify/some-name/`: `record.json` with all of it, and the figures.
"""
