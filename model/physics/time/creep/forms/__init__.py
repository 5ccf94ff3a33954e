"""The forms of creep: how its rate depends on the stress, φ = c₀ f(σ/σ₀)^N.

A form is a file here, without numba, named in FORMS; entries, kernels, fits and commands follow. It has

    TEXT            what it is, for the entry `form` of a material file, whose word is the file's name
    HOMOGENEOUS     whether f is a power, so that σ₀ is no constant of its own
    factor(x)       f and d log f/d log x of a number x > 0; is compiled
    logarithm(x)    log f of an array
"""

from coilset.model.physics.time.creep.forms import garofalo, norton_bailey

FORMS = {one.__name__.rpartition(".")[2]: one for one in (norton_bailey, garofalo)}
