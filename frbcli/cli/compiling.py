"""The first start: kernels are compiled once and kept beside the sources, with progress on the terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from frbcli.cli.common import Terminal

if TYPE_CHECKING:
    from frbcli.case.schema import Case

EVERY_s = 10.0  # between two lines where no line moves on the screen


@contextmanager
def compilation_shown(terminal: Terminal, case: Case, show: Callable[[str], None] | None = None) -> Iterator[None]:
    """Within it, the terminal shows the progress of the compilation.

    case: determines the number of kernels; show: see Terminal.progress.
    """
    from numba.core.event import Listener, install_listener  # heavy: only where kernels are used

    from frbcli.scene.preparation import compile_s

    about_s = compile_s(case)

    class Count(Listener):
        """Counts the compiled functions, with those that they call."""

        def __init__(self) -> None:
            self._begun, self._told, self._count = 0.0, 0.0, 0

        def on_start(self, _event: Any) -> None:
            if self._begun == 0.0:
                self._begun = self._told = time.monotonic()
                terminal.progress(f"Compiling the kernels, once: about {about_s:.0f} s of CPU time.", show)

        def on_end(self, _event: Any) -> None:
            self._count += 1
            now = time.monotonic()
            if show is not None or now - self._told > EVERY_s:
                self._told = now
                line = f"Compiling the kernels, once: {self._count} functions in {now - self._begun:.0f} s"
                terminal.progress(f"{line} of about {about_s:.0f}.", show)

    with install_listener("numba:compile", Count()):
        yield
