"""What results tell of films at rest: columns of the bearing sheet, some of which stability and response share."""

from __future__ import annotations

from operator import attrgetter

from frbcli.columns import ENTRIES, Column, Shown

# Tables of the terminal
FILMS, WARM, MATRICES, STABILITY = "films", "warm", ("stiffness", "damping"), "stability"

SPEED = Column("speed", "Hz", "rotor speed", shown=(
    *(Shown("Hz", ".3g", table=table) for table in (FILMS, WARM)),
    *(Shown("Hz", ".4g", table=table) for table in MATRICES),
))  # fmt: skip
STATUS = Column("status", "", "`resting` or `not-converged`")
DISPLACEMENT = Column("displacement", "", "displacement of the journal over the clearance", shape=(2,))
ECCENTRICITY = Column("eccentricity", "", "relative eccentricity of the journal", shown=(
    *(Shown("eps", ".3f", table=table) for table in (FILMS, WARM, *MATRICES)), Shown("eps", ".4f", table=STABILITY),
))  # fmt: skip
ATTITUDE = Column(
    "attitude", "deg", "attitude angle", more="from the load line to the displacement, positive counter-clockwise",
    shown=(Shown("att.", ".1f", table=FILMS), Shown("attitude", "{:.1f}°".format, table=STABILITY)),
)  # fmt: skip
STIFFNESS = Column("stiffness", "N/m", "stiffness `-dF/dD` of one bearing", shape=(2, 2),
                   shown=(Shown(ENTRIES, ".4g", "N/um", "stiffness"),))  # fmt: skip
DAMPING = Column("damping", "N s/m", "damping `-dF/dD'` of one bearing", shape=(2, 2),
                 shown=(Shown(ENTRIES, ".4g", "N s/mm", "damping"),))  # fmt: skip
ERROR = Column(
    "coefficient_error", "", "relative error of stiffness and damping", attrgetter("error"),
    more="over the largest entry of each, at the same load", key="error.coefficients_relative",
    shown=tuple(Shown("err.", ".0e", table=table) for table in MATRICES),
)  # fmt: skip

# Of one film among those of a rotor
FILM = (DISPLACEMENT, ECCENTRICITY, ATTITUDE, STIFFNESS, DAMPING, ERROR)

SHEET = (
    Column("film", "", "name of the film, empty of one alone"),
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
    Column("film_thickness_min", "m", "smallest film thickness", shown=(Shown("h", ".3g", "um", FILMS),)),
    Column("p_max", "Pa", "largest absolute pressure", shown=(Shown("p", ".3g", "bar", FILMS),)),
    Column("torque", "N m", "torque on the journal"),
    Column("power", "W", "power that journal and shell put into the film", shown=(Shown("loss", ".4g", table=FILMS),),
           more="their torques times their speeds"),
    Column("side_flow", "m^3/s", "oil that leaves at the open ends", shown=(Shown("flow", ".4g", "mm^3/s", FILMS),),
           more="what flows back into a groove is not part of it"),
    Column("temperature_rise", "K", "temperature rise of that oil if it took all of the power",
           shown=(Shown("rise", ".3g", table=FILMS),), more="with `oil.density` and `oil.heat_capacity`; if the case "
           "gives none, 2000 J/(kg K), or with heat that of the oil at 80 degC"),
    Column("force_error_relative", "", "relative error of the force, from other meshes", attrgetter("force_error"),
           shown=(Shown("err.", ".0e", table=FILMS),), key="error.force_relative"),
    Column("temperature", "K", "temperature of the film, with heat",
           shown=(Shown("temperature, degC", ".2f", "degC", WARM),)),
    Column("viscosity", "Pa s", "viscosity of its oil", shown=(Shown("viscosity, mPa s", ".4g", "mPa s", WARM),)),
    Column("clearance", "m", "clearance", shown=(Shown("clearance, um", ".4g", "um", WARM),)),
    STIFFNESS,
    DAMPING,
    ERROR,
)  # fmt: skip
