"""Two laws written for the tests alone, independent of the material library: elastic, and closed-form radial return."""

import numpy as np


class Elastic:
    """Isotropic elasticity; also serves where only the interface is needed."""

    in_time = None  # neither creep nor rate

    def __init__(self, G=84000.0, nu=0.29):
        self.G, self.nu = G, nu
        self.C = np.zeros((6, 6))
        self.C[:3, :3] = 2 * G * nu / (1 - 2 * nu)
        self.C[range(6), range(6)] += [2 * G] * 3 + [G] * 3

    def initial_state(self, points):
        return np.zeros((points, 13))

    def update(self, old, strain, new, C):
        new[:] = old
        new[:, :6] += strain @ self.C
        C[:] = self.C
        return True


class IdealPlastic(Elastic):
    """von Mises without hardening: radial return in closed form (Simo and Hughes, Computational Inelasticity, 3.3)."""

    def __init__(self, G=84000.0, nu=0.29, shear_yield=150.0):
        super().__init__(G, nu)
        self.k = np.sqrt(2) * shear_yield  # |T| = k at yield

    def update(self, old, strain, new, C):
        super().update(old, strain, new, C)
        volume = np.array([1.0, 1, 1, 0, 0, 0])
        mean = new[:, :3].mean(axis=1)
        T = new[:, :6] - mean[:, None] * volume
        size = np.sqrt(T**2 @ [1, 1, 1, 2, 2, 2])
        ratio = np.minimum(1.0, self.k / np.maximum(size, 1e-300))
        N = T / np.maximum(size, 1e-300)[:, None]
        new[:, :6] = mean[:, None] * volume + ratio[:, None] * T
        new[:, 12] += (1 - ratio) * size / (2 * self.G) * np.minimum(size, self.k)  # plastic work
        deviator = np.diag([1.0, 1, 1, 0.5, 0.5, 0.5]) - np.outer(volume, volume) / 3
        plastic = (ratio < 1)[:, None, None]
        softer = 2 * self.G * (ratio[:, None, None] * deviator - ratio[:, None, None] * N[:, :, None] * N[:, None, :])
        C[:] = np.where(plastic, self.C - 2 * self.G * deviator + softer, self.C)
        return True
