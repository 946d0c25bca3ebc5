"""The first start: kernels are compiled once and kept beside the sources, with progress on the terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from frbcli.cli.common import Terminal

if TYPE_CHECKING:
    from frbcli.case.schema import Case

EVERY_s = 10.0  # between two lines where no line moves on the screen
# A little work of the kind that compiling is, and the CPU time in s that it took where compile_s was measured.
PIECES, REPEATED, REFERENCE_s = 40, 10, 6.5e-3
TRIALS = 5


def slowness() -> float:
    """CPU time of a little work over that on the reference machine: a compilation takes so much longer, since both
    are work of the interpreter, and both are slower where other processes share the core."""
    lines = "\n".join(f"    c{i} = a[{i}] + b * {i}.0 if a else (b, {i})" for i in range(PIECES))
    text, spent = f"def f(a, b):\n{lines}\n    return c1\n", []
    for _ in range(TRIALS):
        began = time.process_time()
        for _ in range(REPEATED):
            compile(text, "work", "exec")
        spent.append(time.process_time() - began)
    return sorted(spent)[TRIALS // 2] / REFERENCE_s


@contextmanager
def compilation_shown(
    terminal: Terminal, case: Case, show: Callable[[str], None] | None = None, also: Iterable[Case] = ()
) -> Iterator[None]:
    """Within it, the terminal shows the progress of the compilation.

    case, also: what is computed, which determines the kernels; show: see Terminal.progress.
    """
    from numba.core.event import Listener, install_listener  # heavy: only where kernels are used

    from frbcli.scene.costs.preparation import compile_s

    class Compilations(Listener):
        """Counts the compiled functions, with those that they call."""

        def __init__(self) -> None:
            self._begun, self._told, self._count, self._about_s = 0.0, 0.0, 0, 0.0

        def on_start(self, _event: Any) -> None:
            if self._begun == 0.0:
                self._about_s = compile_s([case, *also]) * slowness()
                self._begun = self._told = time.monotonic()
                terminal.progress(f"Compiling the kernels, once: about {self._about_s:.0f} s of CPU time.", show)

        def on_end(self, _event: Any) -> None:
            self._count += 1
            now = time.monotonic()
            if show is not None or now - self._told > EVERY_s:
                self._told = now
                line = f"Compiling the kernels, once: {self._count} functions in {now - self._begun:.0f} s"
                terminal.progress(f"{line} of about {self._about_s:.0f}.", show)

    with install_listener("numba:compile", Compilations()):
        yield
