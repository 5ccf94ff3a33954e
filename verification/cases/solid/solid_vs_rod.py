"""The coil section as a 3D solid: against Wahl and Göhner, and the rod against it

One turn of Ck 15 between clamped heads, wire 5 mm, D/d = 8, pitch 12 mm, is compressed nine tenths of the way to block
and released, as a solid and as a rod. Compared are axial force, torque, set and the shear stress over the section of
the wire. The elastic turn without pitch gives the shear factor at the inside of the coil for D/d = 4 and 12.

Where the wire is elastic, the rod misses the curvature of the coil: its rate is 11/16 (d/D)² too low (3/16 because
Göhner's curved wire is stiffer, 1/2 because the rod's shear makes it softer), and its shear stress is 3/4 (d/D) too low
at the inside. Plastic flow evens out the force; the set is too small by the excess springback, and the residual stress
at the inside is too small. All indices and meshes: `python -m coilset.verification.solid_study FOLDER whole`; the
results are in docs/solid.md.
"""

import shutil

from mpi4py import MPI

from coilset.verification.solid_study import figures
from coilset.verification.solid_study import study as solid_study
from coilset.verification.solid_study.store import Store
from coilset.verification.study import Study


def run(study: Study) -> None:
    """The standard case; an interrupted one resumes where it stopped."""
    store = Store(study.folder / "unfinished", MPI.COMM_SELF, lambda line: print(line, flush=True))
    found = solid_study.run(store)
    for record in solid_study.records(found):
        study.check(**record)
    columns = ["case", "unknowns", "quantity", "solid", "rod", "rod/solid − 1"]
    study.table("N, N mm, mm, MPa", columns, solid_study.table(found))
    for name, figure in figures.draw(found).items():
        study.figure(name, figure)
    shutil.rmtree(store.folder)
