"""Cavitation laws that were added from Python: cases take them in this process, with the keys of their tables."""

from __future__ import annotations

from frbcli.case.bearing import CartridgeBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.elements import BallBearingKeys, CoefficientsBearing
from frbcli.case.film_geometry import RingFilm
from frbcli.case.film_tables import adopt
from frbcli.case.films.film_model import FilmModel
from frbcli.case.schema import Case
from frbcli.case.surroundings.support import Damper
from frbcli.film.cavitation import table
from frbcli.film.cavitation.law import Law


def add_law(law: type[Law]) -> None:
    """Let film.cavitation take a user-defined law in this process, and [film.NAME] its keys.

    Parameters
    ----------
    law : type[CavitationLaw]
        The law. One of the same name that was added before is replaced.

    Raises
    ------
    ValueError
        If it is no law, or has the name of a shipped law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_law(MyLaw)  # doctest: +SKIP
    """
    table.add(law)
    _adopt()


def remove_law(name: str) -> None:
    """Take a law away that add_law has added.

    Parameters
    ----------
    name : str
        Name of the law.

    Raises
    ------
    KeyError
        For any other law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.remove_law("mine")  # doctest: +SKIP
    """
    table.remove(name)
    _adopt()


def _adopt() -> None:
    adopt(FilmModel, (RingFilm, Damper))
    bearings = (SingleFilmBearing, FloatingRingBearing, CartridgeBearing, CoefficientsBearing, BallBearingKeys)
    for holder in (*bearings, Case):
        holder.model_rebuild(force=True)
