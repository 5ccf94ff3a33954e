"""Residual stress as an X-ray diffractometer sees it: along one direction, mean over a spot and over a depth.

The beam meets the wire along the normal of its surface in the middle of the spot, and the stress is measured along a
direction t in the tangent plane there, at an angle ψ from the wire's axis towards the positive circumference. Of the
stress in the wire's cylindrical components, at the angle δ from the middle of the spot,

    σ(ψ) = σ₁₁ cos²ψ + 2 τ₁θ cos ψ sin ψ cos δ + σθθ sin²ψ cos²δ

for the normal stress on the free surface vanishes. The mean is over the spot, a disk seen along the beam, and over the
depth, with the weight exp(−(z − z₀)/a) below the depth z₀ to which the surface has been removed, a being the depth from
which 1/e of the intensity is left. Removing a layer relaxes what is below it; that is not corrected.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import ConvexHull

from coilset.model.core.base.errors import InputError
from coilset.model.core.results.surface import Inside

DIRECTIONS: Mapping[str, float] = {"along": 0.0, "+45°": 45.0, "around": 90.0, "-45°": -45.0}
ROUND = 0.98  # least radius of a round section over its greatest
ABSORPTION = 5.0  # µm, about that of Cr Kα in steel
RINGS, ANGLES, LAYERS = 6, 16, 8  # of the quadrature of the spot, and of the depth

Field = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""σ₁₁, τ₁₂, τ₁₃, σ₂₂, σ₃₃, τ₂₃, shape (n, 6), MPa, at places s along the wire and y, z across it (y to the coil's
inside), each of shape (n,), mm."""


@dataclass(frozen=True)
class Wire:
    """The stress in a wire near one turn: its field, and its radius, mm."""

    field: Field
    radius: float


class Diffractometer:
    """`coilset.open(folder).xray(turn, angle, ...)`."""

    def __init__(self, data: xr.Dataset) -> None:
        self._data = data

    def __call__(
        self,
        turn: float,
        angle: float = 0.0,
        spot: float = 1.0,
        depth: float = 0.0,
        absorption: float = ABSORPTION,
        snapshot: str | int = -1,
    ) -> xr.Dataset:
        """Stress along the wire, at ±45° and around it.

        Args:
            turn: from the bottom tip; of a slice any.
            angle: about the wire's axis from the inside of the coil, degrees.
            spot: diameter of the irradiated disk, mm; 0: a point.
            depth: of the layer that has been removed, µm.
            absorption: depth from which 1/e of the intensity is left, µm; 0: the surface alone.
            snapshot: name or number of the moment; default is the last.

        Returns:
            Over `direction`: `stress`, as seen, and `point`, at the middle of the spot on the surface itself, MPa.

        Raises:
            InputError: if the wire has no such place, or the spot is wider than the wire.
        """
        wire = _slice(self._data, snapshot) if "section_stress" in self._data else _rod(self._data, turn, snapshot)
        if not 0.0 <= spot < 2.0 * wire.radius:
            raise InputError(f"is {spot:g} mm, but the wire is {2.0 * wire.radius:g} mm thick; give less", "spot")
        if not 0.0 <= 1e-3 * depth < wire.radius or absorption < 0.0:
            raise InputError(f"{depth:g} µm must lie between 0 and the wire's radius", "depth")
        names = list(DIRECTIONS)
        seen = [seen_stress(wire, angle, spot, depth, absorption, ψ) for ψ in DIRECTIONS.values()]
        point = [seen_stress(wire, angle, 0.0, 0.0, 0.0, ψ) for ψ in DIRECTIONS.values()]
        attrs = {"turn": turn, "angle_deg": angle, "spot_mm": spot, "depth_um": depth, "absorption_um": absorption}
        return xr.Dataset(
            {"stress": ("direction", seen, {"units": "MPa"}), "point": ("direction", point, {"units": "MPa"})},
            {"direction": names},
            attrs,
        )


def seen_stress(wire: Wire, angle: float, spot: float, depth: float, absorption: float, direction: float) -> float:
    """Mean stress along one direction, MPa; arguments as of Diffractometer, the direction ψ in degrees."""
    across, along, of_spot = _disk(0.5 * spot)
    deep, of_depth = _layers(depth, absorption)
    x, s, z = (part.ravel() for part in np.broadcast_arrays(across[:, None], along[:, None], deep[None, :]))
    δ = np.arcsin(x / wire.radius)
    θ, r = math.radians(angle) + δ, wire.radius - z
    σ11, τ12, τ13, σ22, σ33, τ23 = wire.field(s, r * np.cos(θ), r * np.sin(θ)).T
    c, n = np.cos(θ), np.sin(θ)
    shear, hoop = τ13 * c - τ12 * n, σ22 * n**2 + σ33 * c**2 - 2.0 * τ23 * c * n
    ψ = math.radians(direction)
    t1, t2 = math.cos(ψ), math.sin(ψ) * np.cos(δ)
    values = (σ11 * t1**2 + 2.0 * shear * t1 * t2 + hoop * t2**2).reshape(len(across), -1)
    return float(of_spot @ values @ of_depth)


def _disk(radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places x, s and weights of a disk's mean."""
    if radius == 0.0:
        return np.zeros(1), np.zeros(1), np.ones(1)
    nodes, weights = np.polynomial.legendre.leggauss(RINGS)
    rings = radius * np.sqrt(0.5 * (nodes + 1.0))
    turn = 2.0 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    x, s = np.outer(rings, np.cos(turn)), np.outer(rings, np.sin(turn))
    return x.ravel(), s.ravel(), np.repeat(0.5 * weights / ANGLES, ANGLES)


def _layers(depth: float, absorption: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths, mm, and weights of the exponential mean; Gauss and Laguerre."""
    if absorption == 0.0:
        return np.array([1e-3 * depth]), np.ones(1)
    nodes, weights = np.polynomial.laguerre.laggauss(LAYERS)
    return 1e-3 * (depth + absorption * nodes), weights


def _rod(data: xr.Dataset, turn: float, snapshot: str | int) -> Wire:
    turns = data["turn"].to_numpy()
    if not turns[0] <= turn <= turns[-1]:
        raise InputError(f"{turn:g} is not on the wire, which has {turns[-1] - turns[0]:g} turns", "turn")
    if "outline" in data:
        raise InputError("diffraction is for round wire; this run's is not", "run")
    shot = data.sel(snapshot=snapshot) if isinstance(snapshot, str) else data.isel(snapshot=snapshot)
    inside = Inside.of(data.attrs["section_kind"] != "plane", _hand(data))
    chords = np.linalg.norm(np.diff(data["position"].isel(snapshot=0).to_numpy(), axis=0), axis=1)
    stations = np.append(0.0, np.cumsum(chords))
    gauss = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3.0)
    places = (stations[:-1, None] + chords[:, None] * gauss).ravel()
    middle = float(np.interp(turn, turns, stations))
    element = int(np.clip(np.searchsorted(stations, middle, side="right") - 1, 0, len(chords) - 1))
    names = [str(name) for name in data["component"].values]
    columns = [names.index(name) if name in names else None for name in ("s11", "t12", "t13", "s22", "s33", "t23")]
    rim = np.radians(data["angle"].to_numpy())
    sign, turned = math.cos(inside.angle), dict[int, Polar]()

    def section(number: int) -> Polar:
        """Of the points of a section and those on its surface; y towards the coil's inside."""
        if number not in turned:
            k, g = divmod(number, 2)
            r = float(data["wire_radius"][k])
            y = np.append(data["y"][k, g].to_numpy(), r * np.cos(rim))
            z = np.append(data["z"][k, g].to_numpy(), r * np.sin(rim))
            rows = np.concatenate([shot["point_state"][k, g].to_numpy(), shot["surface"][k, g].to_numpy()])
            six = np.column_stack([np.zeros(len(rows)) if c is None else rows[:, c] for c in columns])
            turned[number] = Polar(y, z, six)
        return turned[number]

    def field(s: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        at = np.clip(middle + s, places[0], places[-1])
        after = np.clip(np.searchsorted(places, at), 1, len(places) - 1)
        part = (at - places[after - 1]) / (places[after] - places[after - 1])
        found = np.empty((len(at), 6))
        for number in np.unique(after):
            here = after == number
            spots = sign * y[here], sign * z[here]
            low, high = section(int(number) - 1)(*spots), section(int(number))(*spots)
            found[here] = low + part[here, None] * (high - low)
        return found

    return Wire(field, float(data["wire_radius"][element]))


class Polar:
    """Interpolation in a section, linear over angle and radius; where it has no points around, the nearest."""

    def __init__(self, y: np.ndarray, z: np.ndarray, values: np.ndarray) -> None:
        θ, self._rim = np.arctan2(z, y), float(np.hypot(y, z).max())
        places = np.concatenate([self._places(θ + turn, np.hypot(y, z)) for turn in (-2.0 * np.pi, 0.0, 2.0 * np.pi)])
        three = np.tile(values, (3, 1))
        self._linear, self._nearest = LinearNDInterpolator(places, three), NearestNDInterpolator(places, three)

    def _places(self, angle: np.ndarray, radius: np.ndarray) -> np.ndarray:
        return np.column_stack([self._rim * angle, radius])

    def __call__(self, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Values at points, shape (n, components)."""
        places = self._places(np.arctan2(z, y), np.hypot(y, z))
        found = self._linear(places)
        return np.where(np.isnan(found), self._nearest(places), found)


def _slice(data: xr.Dataset, snapshot: str | int) -> Wire:
    shot = data.sel(snapshot=snapshot) if isinstance(snapshot, str) else data.isel(snapshot=snapshot)
    place, stress = data["section_place"].to_numpy(), shot["section_stress"].to_numpy()
    radius = np.hypot(*place.T)[np.unique(ConvexHull(place).vertices)]
    if radius.min() < ROUND * radius.max():
        raise InputError("is of round wire only; this slice has another section", "xray")
    # ξ outward becomes y inward; η and z are both along the binormal
    section = Polar(-place[:, 0], place[:, 1], stress[:, [0, 3, 4, 1, 2, 5]] * np.array([1, -1, 1, 1, 1, -1]))
    return Wire(lambda s, y, z: section(y, z), float(np.hypot(*place.T).max()))


def _hand(data: xr.Dataset) -> int:
    case = json.loads(data.attrs["case"]) if isinstance(data.attrs.get("case"), str) else {}
    return -1 if case.get("spring", {}).get("hand") == "left" else 1


def register() -> None:
    """Make `dataset.xray(...)` available."""
    if not hasattr(xr.Dataset, "xray"):
        xr.register_dataset_accessor("xray")(Diffractometer)
