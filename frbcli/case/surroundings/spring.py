"""Springs, dampers and stops between two places of a machine."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from frbcli.case.quantities import Damping, Identifier, Length, Quantity, Stiffness
from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.machine_table import MachineTable
from frbcli.case.surroundings.places import no_place, node_at
from frbcli.nearest import did_you_mean
from frbcli.rotor.own_laws import keys_of, own_laws
from frbcli.rotor.port import ForceLaw
from frbcli.units import NUMBER, ValueFault, quantity

if TYPE_CHECKING:
    from frbcli.case.schema import Case

Cubic = Annotated[float, Quantity("N/m^3", "1e15 N/m^3", least=0, most=1e30)]
Gap = Annotated[float, Quantity("m", "20 um", least=0)]
Friction = Annotated[float, Quantity(NUMBER, "0.1", least=0)]


class Spring(MachineTable):
    """A spring with damper, or a stop, to ground or between two places."""

    at: Identifier = Field(default="", description="place, as of a [[force]]")
    between: tuple[Identifier, Identifier] | None = Field(
        default=None, description="replaces `at`: two places, such as `compressor` and `housing`"
    )
    stiffness: Stiffness | None = Field(default=None, description="in all directions; of a stop, beyond its gap")
    cubic: Cubic = Field(default=0.0, description="force over displacement cubed")
    gap: Gap = Field(default=0.0, description="radial gap of a stop")
    damping: Damping = Field(default=0.0, description="of a stop, in contact only, without pull")
    friction: Friction = Field(default=0.0, description="of a stop, against sliding of the first place")
    radius: Length | None = Field(
        default=None,
        description="where a turning shaft rubs: sliding by rotation and centre motion; without it by the sense of "
        "rotation",
    )

    law: Identifier = Field(
        default="", description="replaces these: a force law from Python, by its name"
    )
    numbers: dict[str, float | str] = Field(default={}, description="of the law, by the names of its fields")

    @property
    def linear(self) -> bool:
        """Whether its force is proportional to the motion."""
        return not (self.gap or self.cubic or self.friction or self.law)

    @property
    def own_law(self) -> ForceLaw:
        """The force law of its name with its numbers in SI, once its rules hold."""
        kind = own_laws()[self.law]
        return kind(**{name: quantity(self.numbers[name], unit or NUMBER) for name, unit in keys_of(kind).items()})

    @property
    def ends(self) -> tuple[str, str]:
        """Both places; "" is the ground."""
        return self.between or (self.at, "")

    def breaches(self, case: Case, path: Path) -> Iterator[Breach]:
        if bool(self.at) == (self.between is not None):
            problem = "are both given." if self.at else "is missing, and so is at."
            yield Breach((*path, "between"), problem, "Give at, a place, or between, two of them.")
            return
        for place in self.between or (self.at,):
            if not node_at(case, place):
                yield Breach((*path, "between" if self.between else "at"), *no_place(case, place))
        if self.between is not None and len({node_at(case, each) for each in self.between}) == 1:
            yield Breach((*path, "between"), "names one place twice.", "Name two places, or give at.")
        if self.law:
            yield from self._law_breaches(path)
            return
        if self.numbers:
            yield Breach((*path, "numbers"), "has no effect without a law.", "Give the name of a law, or remove it.")
        if not (self.stiffness or self.cubic or (self.damping and self.linear)):
            yield Breach((*path, "stiffness"), "is missing.", "Give a stiffness, cubic or, without a gap, a damping.")
        if self.friction and not self.gap:
            yield Breach(
                (*path, "friction"), "needs a gap: without one nothing slides.", "Give one, or remove it."
            )
        if self.radius is not None and not self.friction:
            yield Breach((*path, "radius"), "has no effect without friction.", "Give a friction, or remove it.")

    def _law_breaches(self, path: Path) -> Iterator[Breach]:
        """What is wrong with a law that was added from Python, or with its numbers."""
        for key in sorted(self.model_fields_set - {"at", "between", "law", "numbers"}):
            yield Breach((*path, key), "has no effect beside a law.", "Remove it.")
        kind = own_laws().get(self.law)
        if kind is None:
            known = ", ".join(own_laws()) or "none"
            remedy = f"Call frbcli.add_force_law in this process before the case is read; added so far: {known}."
            yield Breach((*path, "law"), "is no force law of this process.", remedy)
            return
        keys = keys_of(kind)
        for name in keys.keys() - self.numbers.keys():
            yield Breach((*path, "numbers"), f"lacks {name}.", f"Give {', '.join(keys)}.")
        for name, value in self.numbers.items():
            if name not in keys:
                yield Breach((*path, "numbers", name), "is no field of the law.", did_you_mean(name, keys))
                continue
            if keys[name] and not isinstance(value, str):
                problem, remedy = "has no unit.", f'Write e.g. "{value:g} {keys[name]}".'
                yield Breach((*path, "numbers", name), problem, remedy)
                continue
            try:
                quantity(value, keys[name] or NUMBER)
            except ValueFault as fault:
                yield Breach((*path, "numbers", name), fault.problem, fault.remedy)
