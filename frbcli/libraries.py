"""Libraries are imported without the settings that lie in the current folder: it may have come from somewhere else, and
some of them name programs and folders of code.

Imports only what Python has imported before: other modules of these names may lie there as well.
"""

import os
import sys

TYPE_CHECKING = False  # of `typing`, which is such a module
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import TypeVar

    Returned = TypeVar("Returned")

HERE = (".numba_config.yaml", "matplotlibrc")  # settings of numba and matplotlib
READER = "numba.core.config"  # the module of numba that looks for them as soon as it is imported


def without_settings_here(act: "Callable[..., Returned]", *given: object) -> "Returned":
    """Call a function as if no settings lay in the current folder, and return what it returns."""
    exists, named = os.path.exists, os.environ.get("MATPLOTLIBRC")
    os.path.exists = lambda path: (path not in HERE or path == named) and exists(path)
    try:
        return act(*given)
    finally:
        os.path.exists = exists


class _Finder:
    """Finds numba's reader of settings as other finders do, and runs it without the settings of the current folder."""

    def find_spec(
        self, name: str, path: "Sequence[str] | None" = None, target: "ModuleType | None" = None
    ) -> "ModuleSpec | None":
        """See importlib.abc.MetaPathFinder."""
        if name != READER:
            return None
        others = [finder for finder in sys.meta_path if finder is not self]
        spec = next(filter(None, (finder.find_spec(name, path, target) for finder in others)), None)
        if spec is not None and spec.loader is not None:
            run = spec.loader.exec_module
            setattr(spec.loader, "exec_module", lambda module: without_settings_here(run, module))  # noqa: B010
        return spec


def guard_numba() -> None:
    """Have numba, whoever imports it from now on, read no settings from the current folder."""
    if READER not in sys.modules and not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())
