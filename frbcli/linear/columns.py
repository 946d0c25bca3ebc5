"""The columns of static and linear results: sheets of bearings, balls and collars, stability and unbalance response."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from operator import attrgetter, itemgetter
from typing import Any

import numpy as np

from frbcli.columns import ENTRIES, Column, Shown, named, spaced, speed_shown
from frbcli.units import with_uncertainty

# Tables of the terminal
FILMS, WARM, MIXED, MATRICES = "films", "warm", "mixed", ("stiffness", "damping")
STABILITY, RESPONSE = "stability", "response"

SPEED = Column("speed", "Hz", "rotor speed", shown=(
    *(speed_shown(".3g", table=table) for table in (FILMS, WARM, MIXED)),
    *(speed_shown(table=table) for table in (*MATRICES, STABILITY, RESPONSE)),
))  # fmt: skip
NAME = Column("film", "", "name of the film, empty of one alone")
STATUS = Column("status", "", "`resting` or `not-converged`")
DISPLACEMENT = Column("displacement", "", "journal displacement over clearance", shape=(2,))
ECCENTRICITY = Column("eccentricity", "", "relative eccentricity of the journal", shown=(
    *(Shown("eps", ".3f", table=table) for table in (FILMS, WARM, MIXED, *MATRICES)),
    Shown("eps", ".4f", table=STABILITY),
))  # fmt: skip
ATTITUDE = Column(
    "attitude", "deg", "attitude angle", more="from load to displacement, counter-clockwise",
    shown=(Shown("att., deg", ".1f", table=FILMS), Shown("attitude", "{:.1f}°".format, table=STABILITY)),
)  # fmt: skip
STIFFNESS = Column("stiffness", "N/m", "stiffness `-dF/dD` of one bearing", shape=(2, 2),
                   shown=(Shown(ENTRIES, ".4g", "N/um", "stiffness"),))  # fmt: skip
DAMPING = Column("damping", "N s/m", "damping `-dF/dD'` of one bearing", shape=(2, 2),
                 shown=(Shown(ENTRIES, ".4g", "N s/mm", "damping"),))  # fmt: skip
ERROR = Column(
    "coefficient_error", "", "relative error of stiffness and damping", attrgetter("error"),
    more="over the largest entry, at the same load", key="error.coefficients_relative",
    shown=tuple(Shown("err.", ".0e", table=table) for table in MATRICES),
)  # fmt: skip

PLACE_ERROR = Column("displacement_error", "", "expected error", attrgetter("place_error"),
                     more="over the clearance", key="error.displacement")  # fmt: skip

# Of a RestingFilm
FILM = (DISPLACEMENT, ECCENTRICITY, ATTITUDE, STIFFNESS, DAMPING, ERROR, PLACE_ERROR)


def _tilting(name: str) -> Callable[[Any], Any]:
    return lambda film: None if film.tilting is None else getattr(film.tilting, name)


# Of a RestingFilm or FilmState whose journal tilts
TILTING = (
    Column("tilt", "rad", "tilt of the journal in its shell", _tilting("tilt"), shape=(2,), more="about x and y"),
    Column("tilt_stiffness", "N m", "stiffness in tilt `-dM/dt`", _tilting("tilt_stiffness"), shape=(2, 2)),
    Column("tilt_damping", "N m s", "damping in tilt `-dM/dt'`", _tilting("tilt_damping"), shape=(2, 2)),
)


def film_columns(films: Iterable[Any]) -> tuple[Column, ...]:
    """The columns of these RestingFilms."""
    return (*FILM, *TILTING) if any(film.tilting is not None for film in films) else FILM


# Of a FilmState
SHEET = (
    NAME,
    STATUS,
    Column("problem", "", "why there is no state"),
    SPEED,
    Column("journal_speed", "Hz", "speed of the journal of the film"),
    Column("shell_speed", "Hz", "speed of its shell"),
    Column("load", "N", "load on the journal by one bearing", shape=(2,)),
    DISPLACEMENT,
    ECCENTRICITY,
    ATTITUDE,
    Column("sommerfeld_number", "", "Sommerfeld number (3.14)", shown=(Shown("So", ".3g", table=FILMS),),
           more="`F psi^2 / (D B eta omega)` with `omega = omega_J + omega_S`"),
    Column("film_thickness_min", "m", "smallest film thickness", shown=(Shown("h, um", ".3g", "um", FILMS),)),
    Column("p_max", "Pa", "largest absolute pressure", shown=(Shown("p, bar", ".3g", "bar", FILMS),)),
    Column("torque", "N m", "torque on the journal"),
    Column("friction_coefficient", "", "coefficient of friction of the journal", more="`mu = |T| / (R F)`",
           shown=(Shown("mu", ".3g", table=MIXED),)),
    Column("friction_variable", "", "`mu R / C`", more="`pi / So` of a journal in the middle of a shell at rest"),
    Column("power", "W", "power that journal and shell put into the film", more="their torques times their speeds",
           shown=(Shown("loss, W", ".4g", table=FILMS),)),
    Column("side_flow", "m^3/s", "oil that leaves at the open ends",
           shown=(Shown("flow, l/min", ".3g", "l/min", FILMS),),
           more="what flows back into a groove is not part of it"),
    Column("temperature_rise", "K", "temperature rise of that oil if it took all of the power",
           shown=(Shown("rise, K", ".3g", table=FILMS),),
           more="with `oil.density` and `oil.heat_capacity`; if the case gives none, 2000 J/(kg K), or with heat "
                "the oil's at 80 degC"),
    Column("force_error_relative", "", "relative error of the force, from other meshes", attrgetter("force_error"),
           key="error.force_relative"),
    Column("largest_error", "", "largest relative error of force, h, p, loss and flow",
           shown=(Shown("err.", ".0e", table=FILMS),), key="", flat=False),
    Column("temperature", "K", "temperature of the film",
           shown=(Shown("temperature, degC", ".2f", "degC", WARM),)),
    Column("viscosity", "Pa s", "viscosity of its oil", shown=(Shown("viscosity, mPa s", ".4g", "mPa s", WARM),)),
    Column("clearance", "m", "clearance", shown=(Shown("clearance, um", ".4g", "um", WARM),)),
    STIFFNESS,
    DAMPING,
    ERROR,
    PLACE_ERROR,
    Column("film_thickness_min_error", "m", "expected error of the smallest film thickness",
           attrgetter("film_thickness_error"), more="equals the displacement error", key="error.film_thickness_min_m"),
    Column("p_max_error", "Pa", "expected error of the largest pressure", more="by the mesh, and by the displacement",
           key="error.p_max_Pa"),
    Column("power_error", "W", "expected error of the power", more="likewise", key="error.power_W"),
    Column("side_flow_error", "m^3/s", "expected error of the flow", more="likewise", key="error.side_flow_m3_s"),
)  # fmt: skip


def _mixed(name: str) -> Callable[[Any], Any]:
    return lambda state: math.nan if state.mixed is None else getattr(state.mixed, name)


# Of a FilmState between rough surfaces
MIXED_FRICTION = (
    Column("film_parameter", "", "smallest film thickness over the roughness", _mixed("film_parameter"),
           shown=(Shown("h/rough.", ".3g", table=MIXED),)),
    Column("asperity_share", "", "share of the load that asperities carry", _mixed("share"),
           shown=(Shown("share", ".3g", table=MIXED),)),
    Column("contact_torque", "N m", "part of the torque that is friction of asperities", _mixed("torque")),
    Column("contact_power", "W", "part of the power that is friction of asperities", _mixed("power"),
           shown=(Shown("contact", ".3g", table=MIXED),)),
    Column("asperity_share_error", "", "expected error of the share of the load", _mixed("share_error"),
           more="by the error of the displacement", key="error.asperity_share"),
)  # fmt: skip


def sheet_columns(rough: bool, tilting: bool) -> tuple[Column, ...]:
    """Columns of the FilmStates of a case. rough: whether its surfaces are; tilting: whether its journals tilt."""
    return (*SHEET, *(TILTING if tilting else ()), *(MIXED_FRICTION if rough else ()))


GROWTH = Column("growth", "1/s", "growth of the least damped whirl", more="above 0 it hides the unbalance response",
                shown=(Shown("growth", ".3g", table=RESPONSE),))  # fmt: skip

# Of a StabilityPoint; of several films each has its columns, with its name at their end
POINT = (SPEED, STATUS, GROWTH,
         Column("frequency", "Hz", "frequency of the least damped whirl",
                lambda point: point.critical.imag / (2 * math.pi)),
         Column("growing_modes", "", "growing modes", lambda point: len(point.growing)),
         Column("growth_error", "1/s", "expected error", lambda point: point.critical_error, key="error.growth_1_s"),
         Column("frequency_error", "Hz", "expected error",
                lambda point: point.critical_error / (2 * math.pi), key="error.frequency_Hz"))  # fmt: skip

# Of an Eigenvalue
MODES = (
    Column("frequency", "Hz", "frequency of a mode", lambda mode: mode.value.imag / (2 * math.pi),
           shown=(Shown("mode Hz", ".1f", table=STABILITY),)),
    Column("damping_ratio", "", "damping ratio, below 0 of a growing mode",
           lambda mode: 0.0 - mode.value.real / abs(mode.value), shown=(Shown("damping", ".4f", table=STABILITY),),
           key="damping"),
    Column("growth", "1/s", "real part of the eigenvalue", attrgetter("value.real"),
           shown=(Shown("growth 1/s", ".1f", table=STABILITY),)),
    Column("frequency_error", "Hz", "expected error", lambda mode: mode.error / (2 * math.pi),
           key="error.frequency_Hz"),
    Column("growth_error", "1/s", "expected error", attrgetter("error"), key="error.growth_1_s"),
)  # fmt: skip


def _size(motion: Any) -> Any:
    """Absolute values, which of whole arrays abs() rounds otherwise on other processors."""
    return np.hypot(motion.real, motion.imag)


# Of a DampedMode
DAMPED_MODES = (
    Column("frequency", "Hz", "frequency"),
    Column("frequency", "", "", lambda mode: with_uncertainty(mode.frequency_Hz, mode.error / (2 * math.pi), 3),
           shown=(Shown("Hz"),), key="", flat=False),
    Column("direction", "", "`forward` or `backward`", shown=(Shown("whirl"),)),
    Column("growth", "1/s", "real part of the eigenvalue", attrgetter("eigenvalue.real")),
    Column("growth", "", "", lambda mode: with_uncertainty(mode.eigenvalue.real, mode.error, 3),
           shown=(Shown("growth, 1/s"),), key="", flat=False),
    Column("damping_ratio", "", "share of the critical damping", shown=(Shown("damping", ".3g"),)),
    Column("logarithmic_decrement", "", "logarithmic decrement", shown=(Shown("log. decrement", ".3g"),)),
    Column("frequency_error", "Hz", "expected error", lambda mode: mode.error / (2 * math.pi),
           key="error.frequency_Hz"),
    Column("growth_error", "1/s", "expected error", attrgetter("error"), key="error.growth_1_s"),
)  # fmt: skip

# Of a Mode of a rotor on springs
NATURAL_MODES = (
    Column("frequency", "Hz", "natural frequency", shown=(Shown("Hz", ".4g"),)),
    Column("direction", "", "`forward` or `backward`"),
    Column("kind", "", "`conical`, `cylindrical` or `bending`", shown=(Shown("kind", "{:.3}".format),)),
)

# Of a Modes; the frequency is None for a free rotor
REDUCTION = (
    Column("modes", "", "modes of each plane", attrgetter("kept")),
    Column("frequency_relative", "", "change of the frequencies",
           lambda modes: None if modes.error is None else modes.error.frequency),
    Column("missing_flexibility", "m/N", "neglected flexibility",
           lambda modes: None if modes.error is None else modes.error.missing_flexibility),
)

_SPEEDS = replace(SPEED, value=lambda sweep: sweep.speeds_Hz[:, None])

# Of a Response, over speeds and points
RESPONSE_POINTS = (
    _SPEEDS,
    Column("point", "", "point", attrgetter("points"), key="node"),
    Column("amplitude", "m", "larger semi-axis of the orbit", shown=(Shown("um", ".3g", "um", RESPONSE),)),
    Column("amplitude_error", "m", "expected error", lambda sweep: sweep.amplitude_error, key="error.amplitude_m"),
    Column("phase", "deg", "phase of the forward motion to the rotor",
           shown=(Shown("deg", "{:.0f}°".format, table=RESPONSE),)),
    Column("x", "m", "amplitude along this axis", lambda sweep: _size(sweep.motion[:, :, 0])),
    Column("y", "m", "amplitude along this axis", lambda sweep: _size(sweep.motion[:, :, 1])),
    Column("forward", "m", "amplitude of this part", lambda sweep: abs(sweep.forward)),
    Column("backward", "m", "amplitude of this part", lambda sweep: abs(sweep.backward)),
    replace(GROWTH, value=lambda sweep: sweep.growth[:, None]),
    Column("eccentricity_max", "", "largest eccentricity of a journal on its orbit",
           lambda sweep: sweep.eccentricity_max.max(axis=1, initial=0.0)[:, None],
           shown=(Shown("eps", ".3g", table=RESPONSE),)),
    Column("validity", "", "`linear`, `doubtful` or `beyond-gap`", lambda sweep: np.array(sweep.validity)[:, None]),
)  # fmt: skip

# Of a CriticalSpeed
PEAKS = (
    Column("speed", "Hz", "speed of a peak of the response", attrgetter("speed_Hz"),
           shown=(speed_shown(".6g", table=RESPONSE),)),
    Column("speed_uncertainty", "Hz", "expected error", attrgetter("speed_uncertainty_Hz"),
           more="by search and mesh"),
    Column("mode", "", "number of the resonant mode", shown=(Shown("mode", table=RESPONSE),)),
    Column("direction", "", "`forward`, `backward` or `mixed`", shown=(Shown("whirl", table=RESPONSE),)),
    Column("node", "", "point with the largest amplitude",
           shown=(Shown("point", spaced, table=RESPONSE),)),
    Column("amplitude", "m", "larger semi-axis of its orbit", more="none without damping",
           shown=(Shown("um", ".4g", "um", RESPONSE),)),
    Column("amplification_factor", "", "speed over the width of the peak at 0.707 of its height",
           shown=(Shown("factor", ".3g", table=RESPONSE),)),
    Column("separation_margin", "", "distance from the operating range, over its nearer limit",
           shown=(Shown("margin", ".1%", table=RESPONSE),)),
    Column("logarithmic_decrement", "", "logarithmic decrement of the mode",
           shown=(Shown("decrement", ".3g", table=RESPONSE),)),
)  # fmt: skip

_NAMES = replace(NAME, value=attrgetter("films"))

# Of a Response, over speeds and films
RESPONSE_FORCES = (
    _SPEEDS,
    replace(NAME, value=attrgetter("bearings")),
    Column("force_x", "N", "amplitude of the force on the journal", lambda sweep: _size(sweep.forces[:, :, 0])),
    Column("force_y", "N", "amplitude of the force on the journal", lambda sweep: _size(sweep.forces[:, :, 1])),
)
RESPONSE_FILMS = (
    _SPEEDS,
    _NAMES,
    Column("gap_share", "", "larger semi-axis over the smallest static gap"),
    Column("eccentricity_max", "", "largest eccentricity on the orbit"),
)

# Of a StabilityPoint and one of its films
RESPONSE_COEFFICIENTS = (
    *named((SPEED,), "", itemgetter(0)),
    *named((replace(NAME, value=attrgetter("name")), STIFFNESS, DAMPING, ERROR), "", itemgetter(1)),
)


def point_columns(films: Sequence[str], columns: tuple[Column, ...] = FILM) -> tuple[Column, ...]:
    """The columns of the points of a rotor with films of these names; columns: of each film."""
    names = [name if len(films) > 1 else "" for name in films]
    own = [column for i, name in enumerate(names) for column in named(columns, name, _film(i))]
    return (*POINT[:2], *own, *POINT[2:])


def _film(i: int) -> Callable[[Any], Any]:
    return lambda point: point.films[i] if point.films else None


BALLS, STIFFNESSES, FREQUENCIES = "balls", "stiffness", "frequencies"
BALL_TABLES = (BALLS, STIFFNESSES, FREQUENCIES)


# Of a BallState
BALL_SHEET = (
    Column("bearing", "", "name of the ball bearing, empty of one alone"),
    Column("status", "", "`resting` or `not-converged`"),
    Column("problem", "", "why there is no state"),
    Column("speed", "Hz", "rotor speed", shown=tuple(speed_shown(table=table) for table in BALL_TABLES)),
    Column("load", "N", "load on the inner ring by one bearing", shape=(2,),
           shown=(Shown(("Fx", "Fy"), ".4g", table=BALLS), Shown(("Fx", "Fy"), ".4g", table=STIFFNESSES))),
    Column("axial_force", "N", "axial force on the balls of a row", shown=(Shown("Fa", ".4g", table=BALLS),),
           more="the preload of a spring, or what rings bear that are held"),
    Column("displacement", "m", "displacement of the inner ring", shape=(2,),
           shown=(Shown(("x", "y"), ".3g", "um", STIFFNESSES),)),
    Column("axial_displacement", "m", "axial displacement of the inner ring from its first contact",
           shown=(Shown("z", ".3g", "um", STIFFNESSES),)),
    Column("stiffness", "N/m", "stiffness `-dF/dD` of one bearing", shape=(2, 2), more="under a preload by a spring "
           "with the rings free along the axis", shown=(Shown(ENTRIES, ".4g", "N/um", STIFFNESSES),)),
    Column("damping", "N s/m", "damping `-dF/dD'` of one bearing, as given", shape=(2, 2)),
    Column("axial_stiffness", "N/m", "axial stiffness with the ring held in x and y",
           shown=(Shown("zz", ".4g", "N/um", STIFFNESSES),)),
    Column("inner_angle", "deg", "contact angle at the inner ring of the ball with the largest load",
           shown=(Shown("a_i", ".3g", table=BALLS),)),
    Column("outer_angle", "deg", "contact angle there at the outer ring", shown=(Shown("a_o", ".3g", table=BALLS),)),
    Column("inner_load", "N", "largest load of a ball at the inner ring", shown=(Shown("Q_i", ".4g", table=BALLS),)),
    Column("outer_load", "N", "largest load of a ball at the outer ring", shown=(Shown("Q_o", ".4g", table=BALLS),)),
    Column("inner_p_max", "Pa", "largest Hertz pressure at the inner ring",
           shown=(Shown("p_i", ".4g", "MPa", BALLS),)),
    Column("outer_p_max", "Pa", "largest Hertz pressure at the outer ring",
           shown=(Shown("p_o", ".4g", "MPa", BALLS),)),
    Column("balls_apart", "", "balls of a row without contact with the inner ring",
           shown=(Shown("apart", "d", table=BALLS),)),
    Column("cage_frequency", "Hz", "speed of the cage", shown=(Shown("cage", ".5g", table=FREQUENCIES),)),
    Column("ball_pass_outer", "Hz", "passing of balls at the outer ring",
           shown=(Shown("outer", ".5g", table=FREQUENCIES),)),
    Column("ball_pass_inner", "Hz", "passing of balls at the inner ring",
           shown=(Shown("inner", ".5g", table=FREQUENCIES),)),
    Column("ball_spin", "Hz", "spin of a ball", shown=(Shown("spin", ".5g", table=FREQUENCIES),)),
    Column("rating_life", "h", "basic rating life L10 by the loads of the balls, ISO/TS 16281", attrgetter("life_h"),
           more="with `dynamic_rating`", shown=(Shown("life", "{:.3g} h".format, table=FREQUENCIES),)),
)  # fmt: skip


TILT_STIFFNESS, TILT_DAMPING = "tilt stiffness", "tilt damping"
PAD_TABLES = (FILMS, TILT_STIFFNESS, TILT_DAMPING)


def _in_um(gap: float) -> str:
    return f"{1e6 * gap:.3g} um"


def _direct_and_cross(matrix: Any) -> str:
    return f"{matrix[0, 0]:.3g} N m/rad, across {matrix[1, 0]:.3g} N m/rad"


# Of a ThrustState
THRUST = (
    Column("bearing", "", "name of the thrust bearing, empty of one alone"),
    Column("speed", "Hz", "rotor speed", shown=tuple(speed_shown(table=table) for table in PAD_TABLES)),
    Column("gap", "m", "smallest gap of the runner without tilt",
           shown=(*(Shown("gap, um", ".3g", "um", table) for table in PAD_TABLES),
                  Shown("gap", _in_um, table=STABILITY)),
           more="over the lands; with pads on both sides on the side that `load` presses on"),
    Column("load", "N", "load that the film carries", shown=(Shown("load, N", ".4g", table=FILMS),),
           more="with pads on both sides the difference of the two"),
    Column("torque", "N m", "torque that resists the rotation"),
    Column("power", "W", "power loss", more="torque times speed",
           shown=(Shown("loss, W", ".4g", table=FILMS), Shown("loss", "{:.4g} W".format, table=STABILITY))),
    Column("flow_inner", "m^3/s", "oil that leaves at the inner radius",
           shown=(Shown("inner, l/min", ".3g", "l/min", FILMS),)),
    Column("flow_outer", "m^3/s", "oil that leaves at the outer radius",
           shown=(Shown("outer, l/min", ".3g", "l/min", FILMS),)),
    Column("flow_leading", "m^3/s", "oil that enters at the leading edges of the pads"),
    Column("p_max", "Pa", "largest absolute pressure", shown=(Shown("p, bar", ".3g", "bar", FILMS),)),
    Column("stiffness", "N/m", "axial stiffness `-dW/dz`", shown=(Shown("k, N/um", ".4g", "N/um", FILMS),)),
    Column("damping", "N s/m", "axial damping `-dW/dz'`", shown=(Shown("c, N s/mm", ".3g", "N s/mm", FILMS),)),
    Column("tilt_stiffness", "N m", "stiffness in tilt `-dM/dtilt`, per rad", shape=(2, 2),
           shown=(Shown(ENTRIES, ".4g", table=TILT_STIFFNESS),
                  Shown("stiffness in tilt", _direct_and_cross, table=STABILITY))),
    Column("tilt_damping", "N m s", "damping in tilt `-dM/dtilt'`, per rad", shape=(2, 2),
           shown=(Shown(ENTRIES, ".4g", table=TILT_DAMPING),)),
    Column("viscosity", "Pa s", "viscosity of the oil", more="on the loaded side"),
    Column("temperature", "K", "temperature of the oil, where the case gives one, or with heat",
           more="on the loaded side"),
    Column("load_error_relative", "", "relative error of the load, from another mesh", attrgetter("load_error"),
           shown=(Shown("err.", ".0e", table=FILMS),), key="error.load_relative"),
    Column("coefficient_error", "", "relative error of stiffness and damping, axial and in tilt",
           attrgetter("coefficient_error"), key="error.coefficients_relative",
           more="over the largest entry of each",
           shown=tuple(Shown("err.", ".0e", table=table) for table in (TILT_STIFFNESS, TILT_DAMPING))),
)  # fmt: skip

# Of an AxialState
AXIAL = (
    Column("axial_load", "N", "load on the rotor along its axis", more="towards larger positions",
           shown=(Shown("load", "{:.4g} N".format, table=STABILITY),)),
    Column("axial_position", "m", "axial position of the collar", attrgetter("position"),
           more="from the middle of the end play, or from the pads of the only side"),
    Column("axial_frequency", "Hz", "frequency of the motion along the axis", attrgetter("frequency"),
           more="0 where it does not oscillate"),
    Column("axial_growth", "1/s", "growth", attrgetter("eigenvalue.real"), more="below 0 it decays"),
    *named([column for column in THRUST if column.quantity not in ("bearing", "speed")], "", attrgetter("films")),
)  # fmt: skip
