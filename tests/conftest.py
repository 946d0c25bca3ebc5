"""What holds for all tests, however they were started."""

from __future__ import annotations

import os
import signal

# Ignored signals are inherited: under nohup, and in the background of a script, processes that a test interrupts would
# not hear of it and run on.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

# There are as many workers as cores: threads of the linear algebra would wait for each other, spinning, for three times
# the CPU time. Also of the processes that tests start; set before numpy is imported.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
