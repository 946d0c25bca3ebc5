"""The contract of an element of a machine that is no journal film: a class for each kind, a row of `table.py`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.rotor.assembly import GROUND, Body, Link, NodeForce, PortLink
from frbcli.rotor.loads import LinearPart, Load

Line = tuple[str, str, str]  # of a plan: choice, value, reason


@dataclass(frozen=True)
class Site:
    """The machine around an element. journal, shell: nodes of the shaft and of the shell in a bearing, by its name;
    seat: the node that this shell is fixed to, or in which its damper lies; ground: the node that seat and support
    stand on; count: equal bearings of a symmetric rotor, which move
    as one with the elements of all of them; gravity in m/s^2."""

    journal: Callable[[str], str]
    shell: Callable[[str], str]
    seat: Callable[[str], str]
    ground: Callable[[str], str]
    count: float
    gravity: float


@dataclass(frozen=True)
class Parts:
    """What elements add to a machine: bodies with nodes, linear parts between nodes, constant forces on nodes, loads
    on the x and y of nodes that change with the angle of the rotor or with time, and forces between nodes that are not
    linear, by the names of their signals."""

    bodies: tuple[Body, ...] = ()
    links: tuple[tuple[Link, LinearPart], ...] = ()
    forces: tuple[NodeForce, ...] = ()
    loads: tuple[tuple[str, Load], ...] = ()
    ports: tuple[PortLink, ...] = ()


@dataclass(frozen=True)
class MachineElement(ABC):
    """An element of a case. key: of its table in the case file."""

    key: str

    symbol: ClassVar[str] = ""  # how a sketch draws it at its bearing, a row of report/sketch.py
    arrow: ClassVar[tuple[str, str] | None] = None  # letter and words of its arrow in a sketch
    besides_bearings: ClassVar[bool] = False  # whether it moves shells of bearings, or pulls at the shaft

    @classmethod
    @abstractmethod
    def of(cls, case: Case) -> Iterator[Self]:
        """The elements of this kind in a case."""

    @abstractmethod
    def plan_line(self, site: Site) -> Line:
        """Its line of the plan."""

    @property
    def acts_on(self) -> str:
        """The node at which a sketch draws its arrow, "" of the ground."""
        return GROUND

    @property
    def linear(self) -> LinearPart | None:
        """Its coefficients over the speed, where these hold the shaft as a bearing does."""
        return None

    def stiffness(self, omega: float) -> Array | None:
        """(c, c) its stiffness at omega rad/s, where it holds the shaft as a bearing does; of one that is not linear a
        usual one, for estimates."""
        return None if self.linear is None else self.linear.at(omega)[0]

    def parts(self, site: Site) -> Parts:
        """What it adds to the machine."""
        return Parts()

    def faults(self) -> list[Fault]:
        """What is wrong with it beyond the rules of its keys."""
        return []
