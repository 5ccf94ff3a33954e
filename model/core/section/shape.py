"""Strains at the points of a section: one that stays plane in a straight wire, and one of a curved wire.

The thesis's sections stay plane, in a straight wire (5.2.4), (5.2.42): every fibre is as long as the axis.

In a wire of curvature κ a fibre at the distance y from the axis, towards the centre of curvature, is shorter than the
axis by g = 1 − κ y. The section moves as a rigid disk with the strains Γ = (ε, γ2, γ3) and K = (φ′, κ2, κ3), and warps
along the wire as an elastic disk of radius r does under a transverse force that is constant along it,

    w = −3/7 (γ2 y + γ3 z) (ρ² − 2/3),   ρ² = (y² + z²)/r²,

which minimises ∫ ½ |γ + ∇w|² dA among all w without rotation, ∫ w y dA = ∫ w z dA = 0. The shear stress of the force
then vanishes at the surface as it must (a parabola over the height, 3/2 of the mean in the middle), and the shear
stiffness is 6/7 G A. A curved wire's torsion comes with such a force: without w it is too stiff. With w constant along
the wire in its turning frame, and without its torsion τ,

    ε11 = (ε + κ2 z − κ3 y)/g,   γ12 = (γ2 − φ′ z + κ w)/g + ∂w/∂y,   γ13 = (γ3 + φ′ y)/g + ∂w/∂z,

and the virtual work is ∫ σ : δε g dA. Of a straight wire, κ = 0, this is Timoshenko's rod with its shear factor.
"""

import numpy as np

from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit

SHAPE = 5  # rows of `shape`: g, a22, a23, a32, a33
WARPING = 3.0 / 7.0  # of the transverse shear strain
LEVEL = 2.0 / 3.0  # ρ² where the warping vanishes


@njit(**KERNEL)
def straight_shape(shape: np.ndarray) -> None:
    """Write g, a22, a23, a32, a33 of a section that stays plane in a straight wire, shape (5, points)."""
    shape[:] = 0.0
    shape[0, :] = shape[1, :] = shape[4, :] = 1.0


@njit(**INLINE)
def shear_by_force(y: float, z: float, bend: float, g: float) -> tuple[float, float, float, float]:
    """g ∂(γ12, γ13)/∂(γ2, γ3) at a point of the unit disk, by rows; `bend` is κ r."""
    across = WARPING * (y * y + z * z - LEVEL)
    mixed = 2.0 * WARPING * y * z
    return (
        1.0 - bend * y * across - g * (across + 2.0 * WARPING * y * y),
        -bend * z * across - g * mixed,
        -g * mixed,
        1.0 - g * (across + 2.0 * WARPING * z * z),
    )


@njit(**KERNEL)
def curved_shape(y: np.ndarray, z: np.ndarray, bend: float, shape: np.ndarray) -> None:
    """Write g, a22, a23, a32, a33 at the points of the unit disk, shape (5, points); see `integration`."""
    for k in range(len(y)):
        g = 1.0 - bend * y[k]
        a22, a23, a32, a33 = shear_by_force(y[k], z[k], bend, g)
        shape[0, k], shape[1, k], shape[2, k], shape[3, k], shape[4, k] = g, a22, a23, a32, a33
