"""Text with a unit -> SI number, and back for people. Inside frb everything is SI; units exist at the edges only.

Rotor speeds and frequencies are revolutions per second [Hz] everywhere outside the equations, angles are radians,
temperatures kelvin. pint counts radians and revolutions as dimensionless and so takes "rad/s" for "Hz"; speeds are
therefore read from a table of their own, also those below a torque: "N*m/rpm" is N m over rad/s.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeGuard

if TYPE_CHECKING:
    import pint

SPEED = "Hz"
ANGLE = "rad"
ANGULAR_RATE = "rad/s"
TEMPERATURE_DIFFERENCE = "delta_degC"
NUMBER = "1"
KINEMATIC = "m^2/s"  # of a viscosity

_SPEED_UNITS = {"Hz": 1.0, "kHz": 1e3, "rpm": 1 / 60, "1/min": 1 / 60, "krpm": 1e3 / 60, "rad/s": 1 / (2 * math.pi)}
_PER_MINUTE = ("rpm", "RPM", "1/min", "min^-1", "min-1", "r/min", "rev/min", "U/min", "Upm", "tr/min", "cpm")
_SPEED_SPELLINGS = dict.fromkeys(_PER_MINUTE, "rpm") | {"rev/s": "Hz", "rps": "Hz"}
_ANGLE_UNITS = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "°": math.pi / 180}
_ANGLE_SPELLINGS = {"degree": "deg", "degrees": "deg"}
_ANGULAR_RATE_UNITS = {f"{name}/s": one for name, one in _ANGLE_UNITS.items()}
_NUMBER_UNITS = {"": 1.0, "1": 1.0, "%": 0.01}
_TABLES = {SPEED: _SPEED_UNITS, ANGLE: _ANGLE_UNITS, ANGULAR_RATE: _ANGULAR_RATE_UNITS, NUMBER: _NUMBER_UNITS}
# The units that cases are written in, so that most need no registry of units, which takes a second to load. A test
# holds every factor to the registry; any other unit goes there.
_COMMON: dict[str, dict[str, float]] = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "micron": 1e-6, "microns": 1e-6, "nm": 1e-9,
          "in": 25.4e-3, "inch": 25.4e-3, "mil": 25.4e-6, "mils": 25.4e-6},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "kg*m": {"kg*m": 1.0, "g*mm": 1e-6, "g*m": 1e-3, "kg*mm": 1e-3},
    "kg*m^2": {"kg*m^2": 1.0, "kg*mm^2": 1e-6, "g*mm^2": 1e-9},
    "kg/m^3": {"kg/m^3": 1.0, "g/cm^3": 1e3, "kg/l": 1e3},
    "N": {"N": 1.0, "kN": 1e3},
    "N*m": {"N*m": 1.0, "N*mm": 1e-3, "mN*m": 1e-3, "kN*m": 1e3},
    "N*m*s": {"N*m*s": 1.0},
    "N*m*s^2": {"N*m*s^2": 1.0},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "N/um": 1e6, "kN/mm": 1e6, "MN/m": 1e6},
    "N*s/m": {"N*s/m": 1.0, "N*s/mm": 1e3, "kN*s/m": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "mbar": 1e2, "bar": 1e5, "N/mm^2": 1e6},
    "Pa*s": {"Pa*s": 1.0, "mPa*s": 1e-3, "cP": 1e-3},
    KINEMATIC: {"m^2/s": 1.0, "mm^2/s": 1e-6, "cSt": 1e-6, "St": 1e-4},
    "s": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "m/s^2": {"m/s^2": 1.0},
    "m^3/s": {"m^3/s": 1.0, "l/min": 1e-3 / 60.0, "cm^3/s": 1e-6},
    "1/K": {"1/K": 1.0},
    "J/K": {"J/K": 1.0, "kJ/K": 1e3},
    "W/K": {"W/K": 1.0},
    "J/(kg*K)": {"J/(kg*K)": 1.0, "J/(kg K)": 1.0, "J/kg/K": 1.0, "kJ/(kg*K)": 1e3, "kJ/(kg K)": 1e3},
    "W/(m*K)": {"W/(m*K)": 1.0, "W/(m K)": 1.0, "W/m/K": 1.0},
    TEMPERATURE_DIFFERENCE: {"K": 1.0},
}
_CELSIUS = dict.fromkeys(("degC", "°C", "C", "deg C", "° C", "Celsius"), 273.15)  # K; no temperature is in coulomb
_FAHRENHEIT = ("F", "deg F", "° F", "Fahrenheit")
_PER_SPEED = ("N*m*s", "N*m*s^2")  # of a torque over powers of a speed in rad/s
_OVER_SPEED = re.compile(
    r"(?P<torque>[^/]+)/\s*(?:(?P<plain>[A-Za-z]+)|\((?P<inside>[^()]+)\))(?:\^(?P<power>2))?"
)
_PER_RADIANS = re.compile(r"/\s*rad(?:\^2)?$")  # of N*m*s/rad
_COLD = 100.0  # K, below which nobody writes degC

_TEXT = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
# Thousands apart, as 120 000, which have one reading.
_GROUPED = re.compile(r"(?<!\d)\d{1,3}(?:[ '’_\u00a0\u202f]\d{3})+(?!\d)")
_DECIMAL_COMMA = re.compile(r"([+-]?\d+),(\d+)(.*)", re.DOTALL)
_THOUSANDS = re.compile(r"\d{1,3}\.\d{3}")  # of a speed in rpm: 150.000 is 150 to some and 150 000 to others
_MOST_OF_A_GROUP = 3  # digits behind a mark of thousands
_ABSOLUTE = re.compile(r"(\w+?)\s*(?:a|\(a\)|abs\.?|absolute)")
_GAUGE = re.compile(r"(bar|mbar|psi|kPa|MPa|Pa)\s*(?:g|ü|\([gü]\)|gauge|gage)", re.IGNORECASE)
_ATMOSPHERE = 101325.0  # Pa
_HYPHEN = re.compile(r"(?<=[A-Za-z])[-.](?=[A-Za-z])")  # of g-mm and N.m
_POWER = re.compile(r"(?<=[A-Za-zµ])(?=[2-4](?![0-9]))")  # of kg/m3
# Products as they are written without a sign between their units, and units that the registry knows by other names.
_JOINED = re.compile(r"\b([mkM]?N|m?Pa|k?g)(m|mm|cm|s)(?![A-Za-z])")
_PER_KELVIN = re.compile(r"/(m|kg) ?K$")  # of W/mK, whose kelvin is below the line
_NAMES = {"lbm": "lb", "kp": "kgf", "lpm": "l/min", "gpm": "gallon/min", "GPM": "gallon/min"}
_WEIGHTS = {"lb": "lbf", "oz": "ozf"}  # of masses that stand where a force is meant
_DOUBTFUL = {  # names that the registry takes for what few people mean by them
    "gr": 'is a grain to some and a gram to others. Write "g".',
    **dict.fromkeys(("ton", "tons"), 'is 1000 kg to some and 907 kg or 1016 kg to others. Write "t" for 1000 kg.'),
}
_PEAK_TO_PEAK = re.compile(r"(\S+?)\s*(?:pp|p-p|pk-pk|pkpk)")
LONGEST_UNIT = 100  # characters; longer ones are not searched
LONGEST_SHOWN = 40  # characters of a unit in a fault
# A product of names with one-digit powers, perhaps over one in brackets: all that a case needs, and nothing that pint
# could be kept busy with. It fails on a power of 0.
_FACTOR = r"(?:1|[A-Za-zµμ°]{1,20})(?:(?:\^|\*\*)[+-]?[1-9])?"
_PRODUCT = rf"{_FACTOR}(?:\s*[*/ ]\s*{_FACTOR}){{0,7}}"
_UNIT = re.compile(rf"{_PRODUCT}(?:\s*/\s*\({_PRODUCT}\))?")
_NAME = re.compile(r"[A-Za-zµ°]+")
# To pint some of them are units of their own, such as the atomic mass unit u and Boltzmann's constant k.
_PREFIXES = frozenset(("y", "z", "f", "p", "n", "u", "µ", "c", "da", "k", "M", "G", "E", "Z", "Y"))
_BEFORE_BLANK = re.compile(rf"(?<![A-Za-zµ°])({'|'.join(sorted(_PREFIXES))}|[mdhTP])\s+(?=[A-Za-z])")
_ABBREVIATION = 4  # characters at most: an s behind it is no plural, but may be a second
_SIGNS = {
    "²": "^2", "³": "^3", "⁻": "^-", "¹": "1", "·": "*", "⋅": "*", "×": "*", "μ": "µ", "º": "°", '"': "in", "″": "in",
}  # fmt: skip
_SPELLING = str.maketrans(_SIGNS)

# What people read, by SI unit: (name, SI value of one, SI value from which it is used), smallest first.
_DISPLAY: dict[str, tuple[tuple[str, float, float], ...]] = {
    "m": (("um", 1e-6, 0.0), ("mm", 1e-3, 1e-3), ("m", 1.0, 1.0)),
    "kg": (("g", 1e-3, 0.0), ("kg", 1.0, 1.0)),
    "kg*m": (("g*mm", 1e-6, 0.0),),
    "kg*m^2": (("kg*mm^2", 1e-6, 0.0), ("kg*m^2", 1.0, 0.1)),
    "N/m": (("N/m", 1.0, 0.0), ("N/mm", 1e3, 1e3)),
    "Pa": (("Pa", 1.0, 0.0), ("bar", 1e5, 1e4), ("GPa", 1e9, 1e9)),
    "Pa*s": (("mPa*s", 1e-3, 0.0), ("Pa*s", 1.0, 1.0)),
    "s": (("us", 1e-6, 0.0), ("ms", 1e-3, 1e-3), ("s", 1.0, 0.1)),
    "m^3/s": (("l/min", 1e-3 / 60.0, 0.0),),
    ANGLE: (("deg", math.pi / 180, 0.0),),
    TEMPERATURE_DIFFERENCE: (("K", 1.0, 0.0),),
    NUMBER: (("", 1.0, 0.0),),
}


PER_MINUTE, LEAST_WHOLE = 60.0, 100.0  # rpm over Hz; revolutions per minute from which on whole ones are shown
TWO_DIGITS = 2.0  # an uncertainty that begins with 1 has two digits
ROUND_OFF = 1e-9  # of a number that is rounded up


class ValueFault(ValueError):
    """A value that cannot be taken: what is wrong with it, and what to write instead."""

    def __init__(self, problem: str, remedy: str) -> None:
        self.problem = problem
        self.remedy = remedy
        super().__init__(f"{problem} {remedy}")


def is_number(given: object) -> TypeGuard[int | float]:
    """Whether a value is a number; True and False are none."""
    return isinstance(given, int | float) and not isinstance(given, bool)


def quantity(given: object, unit: str, example: str = "") -> float:
    """The SI value of `given`: a number, taken as SI, or text of a number and a unit such as "35 um".

    unit: the SI unit expected, e.g. "m", "N*s/m", "K" (temperatures: "100 degC" is 373.15), `SPEED` in revolutions per
    second, `ANGLE` in radians, `TEMPERATURE_DIFFERENCE`, `NUMBER` without unit; example: what a good value looks like.
    Text in the SI unit itself is exact, other text is to 15 digits.
    Raises ValueFault for anything else than one finite quantity of this kind.
    """
    remedy = f'Write e.g. "{example}".' if example else f"Write a number in {readable(unit)}."
    if is_number(given):
        return _finite(given, remedy)
    if not isinstance(given, str):
        raise ValueFault("is not a quantity.", remedy)
    text = _without_groups(given)
    parts = _TEXT.fullmatch(text)
    if parts is None:
        raise ValueFault("is not a number with a unit.", remedy)
    if comma := _DECIMAL_COMMA.fullmatch(text):
        raise _with_comma(*comma.groups())
    number, unit_text = parts[1], _spelled(parts[2])
    if unit == SPEED and unit_text in _PER_MINUTE and _THOUSANDS.fullmatch(number):
        plain = f"{float(number):g} {unit_text}"
        raise ValueFault(
            f"can be {plain} or {number.replace('.', '')} {unit_text}.",
            f'Write "{plain}" or "{number.replace(".", "")} {unit_text}".',
        )
    value = _finite(number, remedy)
    si = _finite(_to_si(value, unit_text, unit, remedy), remedy)
    if si == 0.0 and re.search("[1-9]", re.split("[eE]", number)[0]):
        raise ValueFault("is too small a number.", remedy)
    return si


def is_kinematic(given: object) -> bool:
    """Whether `given` is text of a kinematic viscosity, such as "12 cSt"."""
    return _unit_of(given) in _COMMON[KINEMATIC]


def is_per_minute(given: object) -> bool:
    """Whether `given` is text of a speed in revolutions per minute, such as "9000 rpm"."""
    return _unit_of(given) in (*_PER_MINUTE, "krpm")


def _unit_of(given: object) -> str:
    """The unit of a quantity, "" of anything else."""
    parts = _TEXT.fullmatch(_without_groups(given)) if isinstance(given, str) else None
    return "" if parts is None else _spelled(parts[2])


def display(value: float, unit: str) -> str:
    """An SI value as engineers write it: display(35e-6, "m") is "35 um", display(343.15, "K") is "70 degC"."""
    if unit == "K" and value >= _COLD:
        return f"{value - _CELSIUS['degC']:.6g} degC"
    choices = _DISPLAY.get(unit, ((unit, 1.0, 0.0),))
    fitting = [(name, one) for name, one, from_ in choices if abs(value) * (1 + 1e-9) >= from_]
    name, one = fitting[-1] if value else next((each for each in choices if each[1] == 1.0), choices[-1])[:2]
    return f"{value / one:.6g} {name}".rstrip()


def _without_groups(text: str) -> str:
    """Text of a quantity whose number has no marks between thousands."""
    return _GROUPED.sub(lambda number: "".join(filter(str.isdigit, number[0])), text.strip(), count=1)


def _spelled(unit_text: str) -> str:
    """A unit with single blanks, and with its signs and powers in one spelling."""
    return _POWER.sub("^", " ".join(unit_text.translate(_SPELLING).split()))


def _finite(number: object, remedy: str) -> float:
    try:
        value = float(number)  # type: ignore[arg-type]
    except OverflowError:  # a whole number beyond the range of a double
        value = math.inf
    if not math.isfinite(value):
        raise ValueFault("is not a finite number.", remedy)
    return value


def _with_comma(whole: str, decimals: str, unit: str) -> ValueFault:
    """The fault of a number with a comma, which is a decimal one to some and a mark of thousands to others."""
    plain = f"{whole}.{decimals}{unit}"
    if len(decimals) != _MOST_OF_A_GROUP or not whole.strip("+-0"):
        return ValueFault("has a decimal comma.", f'Write "{plain}".')
    return ValueFault("has a comma, for decimals or for thousands.", f'Write "{plain}" or "{whole}{decimals}{unit}".')


def _pressure_unit(number: float, unit_text: str) -> str:
    """The unit of an absolute pressure without a word that says so. Raises ValueFault for a gauge pressure."""
    if gauge := _GAUGE.fullmatch(unit_text):
        one = gauge[1] if gauge[1] in ("mbar", "Pa", "kPa", "MPa") else gauge[1].lower()
        absolute = number + _ATMOSPHERE / _to_si(1.0, one, "Pa", "")
        remedy = f'Write "{absolute:.3g} {one}", with the ambient pressure.'
        raise ValueFault("is a gauge pressure; pressures are absolute here.", remedy)
    absolute_unit = _ABSOLUTE.fullmatch(unit_text)
    return absolute_unit[1] if absolute_unit and absolute_unit[1] in ("bar", "mbar", "psi", "kPa", "MPa") else unit_text


def _over_speed(unit_text: str) -> tuple[float, str]:
    """A factor and the unit that is left of a torque over a speed, or over its square: 1 / 2 pi and N*m*s of N*m/Hz."""
    parts = _OVER_SPEED.fullmatch(unit_text)
    speed = "" if parts is None else re.sub(r"\s+", "", parts["plain"] or parts["inside"])
    speed = _SPEED_SPELLINGS.get(speed, speed)
    if parts is None or speed not in _SPEED_UNITS:
        return 1.0, _PER_RADIANS.sub("", unit_text)
    power = int(parts["power"] or 1)
    return (2.0 * math.pi * _SPEED_UNITS[speed]) ** -power, f"{parts['torque'].strip()}*s" + "^2" * (power == 2)


def _to_si(number: float, unit_text: str, unit: str, remedy: str) -> float:
    if unit in _TABLES:
        factors = _TABLES[unit]
        key = re.sub(r"\s+", "", unit_text)
        key = {SPEED: _SPEED_SPELLINGS, ANGLE: _ANGLE_SPELLINGS}.get(unit, {}).get(key, key)
        if key in factors:
            return number if factors[key] == 1.0 else _round(number * factors[key])
        if key == "":
            raise ValueFault("has no unit.", remedy)
        known = ", ".join(name for name in factors if name) if unit != NUMBER else "no unit, or %"
        raise ValueFault(f'has the unit "{_shown(unit_text)}", which does not fit here.', f"{remedy} Known: {known}.")
    if unit_text == "":
        raise ValueFault("has no unit.", remedy)
    if unit_text == readable(unit):
        return number
    if unit == "Pa*s" and unit_text in _COMMON[KINEMATIC]:
        raise ValueFault("is a kinematic viscosity, which needs the density of the oil.", "Give density in [oil].")
    if unit == "Pa":
        unit_text = _pressure_unit(number, unit_text)
    elif unit == "m" and (peaks := _PEAK_TO_PEAK.fullmatch(unit_text)):
        unit_text = peaks[1]
    elif unit in _PER_SPEED:
        per_speed, unit_text = _over_speed(unit_text)
        number *= per_speed
    unit_text = _HYPHEN.sub("*", unit_text)
    if unit == "K" and unit_text in _CELSIUS:
        return _round(number + _CELSIUS[unit_text])
    if unit == "K" and unit_text in _FAHRENHEIT:
        unit_text = "degF"
    factor = _COMMON.get(unit, {}).get(unit_text)
    if factor is not None:
        return _round(number * factor)
    if len(unit_text) > LONGEST_UNIT:
        raise ValueFault(f'has a unit that cannot be read: "{_shown(unit_text)}".', remedy)
    if unit_text != (apart := _apart(unit_text)) and _reads(number, apart, unit):
        return _to_si(number, apart, unit, remedy)
    try:
        return _round(_by_pint(number, unit_text, unit, remedy))
    except ValueFault as fault:
        joined = _BEFORE_BLANK.sub(r"\1", unit_text, count=1)
        if joined == unit_text or not _reads(number, joined, unit):
            raise
        raise ValueFault(fault.problem, f'Write "{number:.15g} {joined}": no blank after a prefix.') from None


def _apart(unit_text: str) -> str:
    """A unit with signs between the units that were joined: Nm is N*m, Ns/m is N*s/m."""
    apart = _PER_KELVIN.sub(r"/(\1*K)", _JOINED.sub(r"\1*\2", unit_text))
    return _NAME.sub(lambda name: _NAMES.get(name[0], name[0]), apart)


def _reads(number: float, unit_text: str, unit: str) -> bool:
    try:
        _to_si(number, unit_text, unit, "")
    except ValueFault:
        return False
    return True


def _shown(unit_text: str) -> str:
    return unit_text if len(unit_text) <= LONGEST_SHOWN else f"{unit_text[:LONGEST_SHOWN]}..."


def _by_pint(number: float, unit_text: str, unit: str, remedy: str) -> float:
    if not _UNIT.fullmatch(unit_text):
        raise ValueFault(f'has a unit that cannot be read: "{_shown(unit_text)}".', remedy)
    names = _NAME.findall(unit_text)
    if doubtful := next((name for name in names if name in _DOUBTFUL), None):
        problem, _, remedy = _DOUBTFUL[doubtful].partition(". ")
        raise ValueFault(f'has the unit "{unit_text}", in which "{doubtful}" {problem}.', remedy)
    if prefix := next((name for name in names if name in _PREFIXES), None):
        raise ValueFault(f'has the unit "{unit_text}", in which "{prefix}" is a prefix without a unit.', remedy)
    import pint

    registry = _registry()
    try:
        for name in names:
            _require_unit(registry, name.replace("°C", "degC"), remedy)
        return float(registry.Quantity(number, unit_text.replace("°C", "degC")).to(unit).magnitude)
    except pint.DimensionalityError:
        force = _NAME.sub(lambda name: _WEIGHTS.get(name[0], name[0]), unit_text)
        if force != unit_text and _reads(number, force, unit):
            remedy = f'Write "{number:.15g} {force}": lb and oz are masses.'
        problem = f'has the unit "{unit_text}", which cannot be turned into {readable(unit)}.'
        raise ValueFault(problem, remedy) from None
    except pint.UndefinedUnitError:
        raise ValueFault(f'has the unit "{unit_text}", which is not known.', remedy) from None
    except ValueFault:
        raise
    except (pint.PintError, ArithmeticError, ValueError, TypeError, AttributeError, LookupError):
        raise ValueFault(f'has the unit "{unit_text}", which does not fit here.', remedy) from None


def _require_unit(registry: pint.UnitRegistry[float], name: str, remedy: str) -> None:
    """Raises ValueFault for names that pint knows and that change nothing, or something else than they say: angles
    and shares, which it counts as numbers, so that 1 rpm would be 2 pi / 60 1/s; the plural of an abbreviation."""
    known = registry.parse_unit_name(name)
    if not known:
        return
    if not registry.get_dimensionality(name) or "radian" in dict(registry.get_root_units(name)[1]._units):
        raise ValueFault(f'has "{name}" in its unit, which is an angle or a plain number.', remedy)
    if name.endswith("s") and len(name) <= _ABBREVIATION + 1 and registry.parse_unit_name(name[:-1]) == known:
        raise ValueFault(f'has "{name}" in its unit, which is no unit.', f'{remedy} "{name[:-1]}" has no plural.')


def _round(value: float) -> float:
    """15 digits: what conversion leaves in the last bit goes, so that "35 um" is 3.5e-5 exactly."""
    return float(f"{value:.15g}")


def readable(unit: str) -> str:
    """The name of an SI unit as people write it."""
    return "K" if unit == TEMPERATURE_DIFFERENCE else unit


@functools.cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry()


def with_uncertainty(value: float | None, uncertainty: float | None, digits: int) -> str:
    """A number with the uncertainty of its last digits in brackets, as 318(4) for 318 +- 4 or 204.4(12) for
    204.4 +- 1.2; without an uncertainty with so many digits behind the point; "-" where there is none."""
    if value is None or math.isnan(value):
        return "-"
    if uncertainty is None or not 0.0 < uncertainty < math.inf:
        return f"{value:.{digits}f}"
    leading = math.floor(math.log10(uncertainty))
    places = 1 - leading if uncertainty < TWO_DIGITS * 10.0**leading else -leading
    places = min(max(places, 0), digits)
    in_last = max(1, math.ceil(uncertainty * 10.0**places - ROUND_OFF))
    return f"{value:.{places}f}({in_last})"


@dataclass(frozen=True)
class SpeedUnit:
    """The unit in which people read rotor speeds: Hz, or revolutions per minute. both: also the other one."""

    rpm: bool = False
    both: bool = False

    @property
    def name(self) -> str:
        """Hz or rpm."""
        return "rpm" if self.rpm else "Hz"

    @property
    def head(self) -> str:
        """The unit in the head of a table."""
        return f"{self.name} ({self._other.name})" if self.both else self.name

    def number(self, speed_Hz: float) -> str:
        """A speed without its unit."""
        value = PER_MINUTE * speed_Hz if self.rpm else speed_Hz
        return f"{value:.0f}" if self.rpm and abs(value) >= LEAST_WHOLE else f"{value:.4g}"

    def cell(self, speed_Hz: float | None, uncertainty_Hz: float | None = None, digits: int = 1) -> str:
        """A speed in a table whose head names the unit, with its uncertainty in brackets. digits: of a speed in Hz
        behind its point; revolutions per minute have none."""
        if speed_Hz is None:
            return "-"
        size = PER_MINUTE if self.rpm else 1.0
        uncertainty = None if uncertainty_Hz is None else size * uncertainty_Hz
        own = with_uncertainty(size * speed_Hz, uncertainty, 0 if self.rpm else digits)
        return f"{own} ({self._other.cell(speed_Hz, uncertainty_Hz)})" if self.both else own

    def words(self, speed_Hz: float, digits: int | None = None) -> str:
        """A speed with its unit. digits: as for `cell`; without them four that count."""
        if digits is None and not self.both:
            return f"{self.number(speed_Hz)} {self.name}"
        one = replace(self, both=False)
        own = f"{one.cell(speed_Hz, digits=1 if digits is None else digits)} {self.name}"
        return f"{own}, {self._other.words(speed_Hz, 1)}" if self.both else own

    def listed(self, speeds_Hz: Iterable[float]) -> str:
        """Several speeds with their unit."""
        return f"{', '.join(map(self.number, speeds_Hz))} {self.name}"

    def span(self, low_Hz: float, high_Hz: float, between: str = "to") -> str:
        """Two speeds with their unit, as 9000 to 12000 rpm."""
        return f"{self.number(low_Hz)} {between} {self.number(high_Hz)} {self.name}"

    @property
    def _other(self) -> SpeedUnit:
        return SpeedUnit(not self.rpm)


HERTZ = SpeedUnit()
