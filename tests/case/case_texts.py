"""Case files as texts, which the tests of this folder read and damage."""

import pytest

from frbcli.case.reading.load import load_case_text
from frbcli.errors import Fault, InputError

SMALL = """
[rotor]
kind = "rigid"
mass = "6.1 kg"
[bearing]
kind = "single-film"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
[oil]
viscosity = "12 mPa*s"
[speed]
from = "0 Hz"
to = "300 Hz"
duration = "10 s"
"""

TURBOCHARGER = """
title = "turbocharger"
[rotor]
kind = "turbocharger"
modes = 6
modal_damping = 0.002
[[shaft]]
length = "100 mm"
diameter = "20 mm"
[[shaft]]
length = "140 mm"
diameter = "28 mm"
[[disk]]
name = "turbine"
position = "224 mm"
mass = "4 kg"
polar_inertia = "4.5e-3 kg*m^2"
diametral_inertia = "4e-3 kg*m^2"
unbalance = "2 g*mm"
phase = "90 deg"
[[bearing]]
kind = "floating-ring"
name = "compressor"
position = "80 mm"
ring = { mass = "75 g", inertia = "20 kg*mm^2" }
[bearing.inner]
width = "20 mm"
diameter = "25 mm"
temperature = "95 degC"
supply = { kind = "bores", count = 6, diameter = "2.5 mm", pressure = "2 bar" }
[bearing.inner.clearance]
cold = "38 um"
shell_temperature = "85 degC"
journal_temperature = "95 degC"
shell_expansion = "1.85e-5 1/K"
journal_expansion = "1.18e-5 1/K"
[bearing.outer]
width = "16 mm"
diameter = "40 mm"
clearance = "50 um"
viscosity = "14 mPa*s"
[[bearing]]
kind = "single-film"
position = "185 mm"
width = "20 mm"
diameter = "25 mm"
clearance = "35 um"
supply = { kind = "pocket", position = "0 deg", opening_angle = "30 deg", width = "10 mm", pressure = "2 bar" }
[oil]
vogel = { eta_0 = "0.06 mPa*s", A = "1000 K", C = "-178 K" }
temperature = "100 degC"
[film]
cavitation = "two-phase"
two-phase = { steepness = 0.95, form = "published", diffusion = "consistent" }
[speed]
from = "0 Hz"
to = "72000 rpm"
duration = "4 s"
[motion]
eccentricity = 0.5
angle = "90 deg"
speed = "20 Hz"
frequency = "10 Hz"
periods = 3
[contact]
policy = "elastic"
stiffness = "1e8 N/m"
[accuracy]
mesh = [10, 20]
[start]
displacement = [0.1, -0.2]
"""


def faults_of(text: str, *settings: str) -> dict[str, Fault]:
    """The faults of a case by their keys."""
    with pytest.raises(InputError) as caught:
        load_case_text(text, settings)
    return {fault.key: fault for fault in caught.value.faults}
