"""What small vibrations and motion in time need of a spring."""

from typing import Protocol

from coilset.model.core.case.case import Case
from coilset.model.core.equilibrium.newton.newton import Newton
from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material.law.law import Law


class AtRest(Protocol):
    """A spring at its last equilibrium, such as an Analysis after its load program.

    Attributes:
        case: from which it is built; law: of its wire.
        system, newton, control: of its equilibrium.
    """

    case: Case
    law: Law
    system: System
    newton: Newton
    control: Heads
