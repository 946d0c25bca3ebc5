"""Pictures of results, one per file; matplotlib lives here only."""

import importlib
import os
from contextlib import suppress
from pathlib import Path

from frbcli.caches import is_trusted, temporary_cache
from frbcli.errors import FrbError
from frbcli.libraries import without_settings_here

LIBRARY = "matplotlib"


def _import_matplotlib() -> None:
    """With the settings of this user, which may name programs, if no other user can change them. Else, or where
    matplotlib could write nothing, which it says in three lines at every start, its folder is a temporary one."""
    if not all(map(_is_usable, _folders())):
        with suppress(OSError):
            os.environ["MPLCONFIGDIR"] = str(temporary_cache())
    try:
        without_settings_here(importlib.import_module, LIBRARY)
    except (OSError, UnicodeError) as error:
        raise FrbError(f"matplotlib cannot read its settings (matplotlibrc): {error}") from error


def _folders() -> list[Path]:
    """Where matplotlib has settings and fonts."""
    own = os.environ.get("MPLCONFIGDIR")
    if own:
        return [Path(own)]
    home = Path(os.path.expanduser("~"))
    places = (("XDG_CONFIG_HOME", ".config"), ("XDG_CACHE_HOME", ".cache"))
    return [Path(os.environ.get(name) or home / folder) / LIBRARY for name, folder in places]


def _is_usable(folder: Path) -> bool:
    """Whether only this user can write there, or make it, and what matplotlib reads there are files."""
    place = next(each for each in (folder.absolute(), *folder.absolute().parents) if each.exists())
    read = [*folder.glob("fontlist-*.json"), *folder.glob("matplotlibrc")]
    return is_trusted(place) and os.access(place, os.W_OK | os.X_OK) and all(map(Path.is_file, read))


_import_matplotlib()
