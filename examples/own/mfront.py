"""A law by MFront's convention: a behaviour's C function, condensed to the three stresses of the wire.

scripts/coilset python examples/own/mfront.py

`mfront --obuild --interface=generic Plasticity.mfront` would build the library. So that the example needs no MFront, a
stand-in with the same arguments is compiled here: von Mises with linear isotropic hardening, by radial return. Its
properties are E, ν, yield stress and slope; its internal variables the elastic strain and the plastic one.
"""

import ctypes
import shlex
import subprocess
import sysconfig
import tempfile
from pathlib import Path

import numpy as np

from coilset.api import Case, Law, condense, solve
from coilset.model.physics.own_laws import mfront

STAND_IN = """
#include <math.h>
typedef struct { double *e, *s, *density, *p, *v, *stored, *dissipated, *external; } State;
typedef struct { char *message; double dt; double *K, *rdt, *sound; State s0, s1; } View;
int Plasticity_Tridimensional(View *d) {
  double E = d->s0.p[0], nu = d->s0.p[1], G = E / (2 + 2 * nu), bulk = E / (3 - 6 * nu), H = d->s0.p[3];
  double el[6], n[6], trace, norm = 0;
  for (int i = 0; i < 6; i++) el[i] = d->s0.v[i] + d->s1.e[i] - d->s0.e[i];
  trace = el[0] + el[1] + el[2];
  for (int i = 0; i < 6; i++) { n[i] = 2 * G * (el[i] - (i < 3 ? trace / 3 : 0)); norm += n[i] * n[i]; }
  double q = sqrt(1.5 * norm), over = q - d->s0.p[2] - H * d->s0.v[6];
  double p = over > 0 ? over / (3 * G + H) : 0, left = over > 0 ? 1 - 3 * G * p / q : 1;
  for (int i = 0; i < 6; i++) {
    n[i] = norm > 0 ? n[i] / sqrt(norm) : 0;
    d->s1.s[i] = left * sqrt(norm) * n[i] + (i < 3 ? bulk * trace : 0);
    d->s1.v[i] = el[i] - sqrt(1.5) * p * n[i];
  }
  d->s1.v[6] = d->s0.v[6] + p;
  double radial = over > 0 ? 2 * G * (3 * G / (3 * G + H) - 1 + left) : 0;
  for (int i = 0; i < 6; i++) for (int j = 0; j < 6; j++)
    d->K[6 * i + j] = 2 * G * left * ((i == j) - (i < 3 && j < 3) / 3.0) + (i < 3 && j < 3) * bulk
      - radial * n[i] * n[j];
  return 1;
}
"""
with tempfile.TemporaryDirectory() as folder:
    source, library = Path(folder, "plasticity.c"), Path(folder, "plasticity.so")
    source.write_text(STAND_IN)
    compiler = shlex.split(sysconfig.get_config_var("CC"))[0]
    subprocess.run([compiler, "-O2", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
    function = ctypes.CDLL(str(library)).Plasticity_Tridimensional

E, ν, yield_stress, H = 210e3, 0.3, 400.0, 2000.0  # as the library's linear_isotropic
law = Law(condense(mfront.behaviour(function, internal=7)), [E, ν, yield_stress, H], mfront.variables(7), "plasticity")
spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 20.0}
mesh = {"elements_per_turn": 8, "section": {"radial": 3, "angular": 8}}
loading = [{"to": {"travel": 30.0}, "steps": 6}, {"to": {"force": 0}, "steps": 2}]
case = Case(
    {"spring": spring, "material": "linear_isotropic", "ends": "clamped", "mesh": mesh, "loading": loading}
    | {"accuracy": "none"}
)
theirs, ours = solve(case), solve(case, law=law)
print(f"set {ours.set:.4f} mm, by the library's law {theirs.set:.4f} mm")
print(f"greatest force {ours.force.max():.2f} N, by the library's law {theirs.force.max():.2f} N")
assert np.allclose(ours.force, theirs.force, rtol=1e-3, atol=1e-3 * theirs.force.max())
assert abs(ours.set / theirs.set - 1.0) < 1e-3
assert theirs.set > 10.0
