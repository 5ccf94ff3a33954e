"""Runs of the slice shared by the cases."""

import time
from dataclasses import dataclass

import numpy as np

from coilset.meshes.sections.mesh import SectionMesh, section_mesh
from coilset.meshes.sections.shapes import Outline, round_wire
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.physics.slice.analysis import ACROSS, INSIDE
from coilset.model.physics.slice.problem import SliceProblem
from coilset.model.physics.slice.slice import Coil, Slice
from coilset.model.physics.slice.watch import Watch

WIRE = 5.0  # mm


@dataclass(frozen=True)
class Elastic:
    """Linear answer of a coil without pitch: unknowns, force per travel of a turn (N/mm), τ13 at places over force."""

    unknowns: int
    rate: float
    shear: np.ndarray


def elastic(outline: Outline, diameter: float, law: Law, across: float, degree: int, places: np.ndarray) -> Elastic:
    """Linear answer of a ring's turns that are pressed together, shear per force at the places (ξ, η), 1/mm²."""
    body = Slice(section_mesh(outline, across, degree, inside=INSIDE), Coil(0.5 * diameter, 0.0), law)
    watch, rise = Watch(body, places), 1e-7 * diameter
    force, stress = SliceProblem(body).probe(-rise, watch)
    return Elastic(body.u.size + 2, force / (2.0 * np.pi * rise), np.abs(stress[:, 4]) / force)


@dataclass(frozen=True)
class Pressed:
    """A turn pressed to nine tenths of the way to block and released.

    Attributes:
        unknowns, seconds: processor time of the steps of compression and release.
        travel, force: of all steps, mm and N; set_mm: travel at no force.
        full, released: τ13 at the places, MPa, under the maximum force and after release.
    """

    unknowns: int
    seconds: float
    travel: np.ndarray
    force: np.ndarray
    set_mm: float
    full: np.ndarray
    released: np.ndarray


def pressed(
    index: float,
    pitch: float,
    travel: float,
    across: float = ACROSS,
    degree: int = 2,
    steps: int = 12,
    material: str = "ck15",
) -> Pressed:
    """Press a turn of round wire in equal steps and release it in one; stress at ξ = −0.9, 0.9 of its radius."""
    section = section_mesh(round_wire(WIRE), across, degree, inside=INSIDE)
    travels = travel * np.arange(1, steps + 1) / steps
    places = np.array([[-0.45 * WIRE, 0.0], [0.45 * WIRE, 0.0]])
    return press(section, Coil(0.5 * index * WIRE, pitch), travels, places, material)


def press(section: SectionMesh, coil: Coil, travel: np.ndarray, places: np.ndarray, material: str = "ck15") -> Pressed:
    """Press a turn to one travel after the other, mm, and release it; stress at the places (ξ, η), mm."""
    body = Slice(section, coil, library.load(material))
    watch = Watch(body, places)
    problem = SliceProblem(body)
    problem.probe(coil.rise * (1 - 1e-9), watch)  # compiles what is not
    began, forces = time.process_time(), [0.0]
    for one in travel:
        problem.go_to_rise(coil.rise - one / (2 * np.pi))
        forces.append(problem.force)
    full = watch.section_stress()[:, 4]
    problem.go_to_force(0.0)
    seconds = time.process_time() - began
    back = 2 * np.pi * (coil.rise - body.rise)
    travels, after = np.append(0.0, travel), watch.section_stress()[:, 4]
    return Pressed(body.u.size + 2, seconds, travels, np.array(forces), back, full, after)
