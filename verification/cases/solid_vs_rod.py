"""The coil section as a 3D solid: against Wahl and Göhner, and the rod against it

One turn of Ck 15 between clamped heads, wire 5 mm, D/d = 8, pitch 12 mm, is pressed to nine tenths of the way to block
and released, as a solid and as a rod: axial force, torque, set and the shear stress over the wire's section. The
elastic turn without pitch gives the shear factor at the inside of the coil for D/d = 4 and 12.

What the rod misses is the coil's curvature where the wire is elastic: its rate is 11/16 (d/D)² too low (3/16 that
Göhner's curved wire is stiffer, 1/2 that the rod's shear makes it softer), and its shear stress lacks 3/4 (d/D) at the
inside. Flow levels the force; the set comes out smaller by what springs back too far, and the residual stress at the
inside too small. All indices and meshes: `python -m coilset.verification.solid_vs_rod FOLDER whole`; what came out is
in docs/solid.md.
"""

import shutil

from mpi4py import MPI

from coilset.verification.solid_vs_rod import figures
from coilset.verification.solid_vs_rod import study as solid_study
from coilset.verification.solid_vs_rod.store import Store
from coilset.verification.study import Study


def run(study: Study) -> None:
    """The standard case; one that was interrupted goes on where it was."""
    store = Store(study.folder / "unfinished", MPI.COMM_SELF, lambda line: print(line, flush=True))
    found = solid_study.run(store)
    for record in solid_study.records(found):
        study.check(**record)
    columns = ["case", "unknowns", "quantity", "solid", "rod", "rod/solid − 1"]
    study.table("N, N mm, mm, MPa", columns, solid_study.table(found))
    for name, figure in figures.draw(found).items():
        study.figure(name, figure)
    shutil.rmtree(store.folder)
