"""Rotordynamics of light, fast rotors in fluid film bearings.

The public names below are imported when they are first used, so that `import frbcli` and `frb --help` cost nothing.
"""

import importlib

from frbcli.libraries import guard_numba

TYPE_CHECKING = False  # for type checkers; `typing` itself would be imported from the current folder if it lay there
if TYPE_CHECKING:  # so that types are known where they are checked
    from frbcli.analysis.events import find_events as find_events
    from frbcli.analysis.measured import Measurement as Measurement
    from frbcli.analysis.measured import measured_run as measured_run
    from frbcli.analysis.order_tracking import order_track as order_track
    from frbcli.analysis.spectrum import waterfall as waterfall
    from frbcli.balancing import TrialRun as TrialRun
    from frbcli.balancing import balance as balance
    from frbcli.case.reading.load import case_from_dict as case_from_dict
    from frbcli.case.reading.load import load_case as load_case
    from frbcli.case.reading.load import load_case_text as load_case_text
    from frbcli.case.reading.shipped import shipped_cases as shipped_cases
    from frbcli.case.schema import Case as Case
    from frbcli.case.schema import add_law as add_law
    from frbcli.case.schema import remove_law as remove_law
    from frbcli.cycles.limit_cycles import limit_cycles as limit_cycles
    from frbcli.cycles.limit_cycles import limit_cycles_over as limit_cycles_over
    from frbcli.cycles.stability_map import stability_map as stability_map
    from frbcli.equilibrium.static_machine import warm_machine as warm_machine
    from frbcli.errors import Fault as Fault
    from frbcli.errors import FrbError as FrbError
    from frbcli.errors import InputError as InputError
    from frbcli.errors import NotConverged as NotConverged
    from frbcli.errors import RunFileError as RunFileError
    from frbcli.linear.balance_quality import balance_quality as balance_quality
    from frbcli.linear.damped_modes import damped_modes as damped_modes
    from frbcli.linear.damped_modes import vibration_limits as vibration_limits
    from frbcli.linear.modes import critical_map as critical_map
    from frbcli.linear.modes import natural_modes as natural_modes
    from frbcli.linear.response import response as response
    from frbcli.linear.sheets.ball import ball_bearing_sheet as ball_bearing_sheet
    from frbcli.linear.sheets.bearing import bearing_sheet as bearing_sheet
    from frbcli.linear.sheets.bearing import sommerfeld_chart as sommerfeld_chart
    from frbcli.linear.sheets.thrust import thrust_sheet as thrust_sheet
    from frbcli.linear.stability import stability as stability
    from frbcli.plot.axes import bearing as draw_bearing  # noqa: F401
    from frbcli.plot.axes import campbell as draw_campbell  # noqa: F401
    from frbcli.plot.axes import eccentricity as draw_eccentricity  # noqa: F401
    from frbcli.plot.axes import film_signal as draw_film_signal  # noqa: F401
    from frbcli.plot.axes import orbit as draw_orbit  # noqa: F401
    from frbcli.plot.axes import response as draw_response  # noqa: F401
    from frbcli.plot.axes import ring_speed as draw_ring_speed  # noqa: F401
    from frbcli.plot.axes import spectrum as draw_spectrum  # noqa: F401
    from frbcli.plot.axes import waterfall as draw_waterfall  # noqa: F401
    from frbcli.plot.picture import picture as picture
    from frbcli.report.page import write_report as write_report
    from frbcli.results.store import read_run as read_run
    from frbcli.rotor.port import ForceLaw as ForceLaw
    from frbcli.rotor.port import add_force_law as add_force_law
    from frbcli.rotor.port import remove_force_law as remove_force_law
    from frbcli.runs.run import rundown as rundown
    from frbcli.runs.run import runup as runup
    from frbcli.scene.planning.plan import make_plan as make_plan
    from frbcli.studies.accuracy import accuracy as accuracy
    from frbcli.studies.against import against_measured as against_measured
    from frbcli.studies.compare import compare as compare
    from frbcli.studies.fit import fit as fit
    from frbcli.studies.sweep import sweep as sweep
    from frbcli.studies.warm_up import warm_up as warm_up


__version__ = "0.1.0"

guard_numba()

_PUBLIC = {  # module, or module:attribute of another name
    "Case": "frbcli.case.schema",
    "Fault": "frbcli.errors",
    "ForceLaw": "frbcli.rotor.port",
    "FrbError": "frbcli.errors",
    "InputError": "frbcli.errors",
    "NotConverged": "frbcli.errors",
    "RunFileError": "frbcli.errors",
    "CavitationLaw": "frbcli.film.cavitation.law:Law",
    "CavitationKey": "frbcli.film.cavitation.law:Key",
    "Measurement": "frbcli.analysis.measured",
    "TrialRun": "frbcli.balancing",
    "accuracy": "frbcli.studies.accuracy",
    "add_force_law": "frbcli.rotor.port",
    "add_law": "frbcli.case.schema",
    "against_measured": "frbcli.studies.against",
    "balance": "frbcli.balancing",
    "balance_quality": "frbcli.linear.balance_quality",
    "ball_bearing_sheet": "frbcli.linear.sheets.ball",
    "bearing_sheet": "frbcli.linear.sheets.bearing",
    "case_from_dict": "frbcli.case.reading.load",
    "compare": "frbcli.studies.compare",
    "draw_bearing": "frbcli.plot.axes:bearing",
    "draw_campbell": "frbcli.plot.axes:campbell",
    "draw_eccentricity": "frbcli.plot.axes:eccentricity",
    "draw_film_signal": "frbcli.plot.axes:film_signal",
    "draw_orbit": "frbcli.plot.axes:orbit",
    "draw_response": "frbcli.plot.axes:response",
    "draw_ring_speed": "frbcli.plot.axes:ring_speed",
    "draw_spectrum": "frbcli.plot.axes:spectrum",
    "draw_waterfall": "frbcli.plot.axes:waterfall",
    "critical_map": "frbcli.linear.modes",
    "damped_modes": "frbcli.linear.damped_modes",
    "find_events": "frbcli.analysis.events",
    "fit": "frbcli.studies.fit",
    "limit_cycles": "frbcli.cycles.limit_cycles",
    "limit_cycles_over": "frbcli.cycles.limit_cycles",
    "load_case": "frbcli.case.reading.load",
    "load_case_text": "frbcli.case.reading.load",
    "make_plan": "frbcli.scene.planning.plan",
    "measured_run": "frbcli.analysis.measured",
    "natural_modes": "frbcli.linear.modes",
    "order_track": "frbcli.analysis.order_tracking",
    "picture": "frbcli.plot.picture",
    "read_run": "frbcli.results.store",
    "remove_force_law": "frbcli.rotor.port",
    "remove_law": "frbcli.case.schema",
    "response": "frbcli.linear.response",
    "rotation": "frbcli.bearing_tests.kinematic",
    "rundown": "frbcli.runs.run",
    "runup": "frbcli.runs.run",
    "shipped_cases": "frbcli.case.reading.shipped",
    "sommerfeld_chart": "frbcli.linear.sheets.bearing",
    "stability_map": "frbcli.cycles.stability_map",
    "squeeze": "frbcli.bearing_tests.kinematic",
    "stability": "frbcli.linear.stability",
    "sweep": "frbcli.studies.sweep",
    "thrust_sheet": "frbcli.linear.sheets.thrust",
    "vibration_limits": "frbcli.linear.damped_modes",
    "warm_up": "frbcli.studies.warm_up",
    "warm_machine": "frbcli.equilibrium.static_machine",
    "whirl": "frbcli.bearing_tests.kinematic",
    "waterfall": "frbcli.analysis.spectrum",
    "write_report": "frbcli.report.page",
}

__all__ = ["__version__", *_PUBLIC]


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, _, attribute = _PUBLIC[name].partition(":")
    return getattr(importlib.import_module(module), attribute or name)


def __dir__() -> list[str]:
    return sorted(__all__)
