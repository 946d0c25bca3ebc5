"""What holds for all tests, however they were started."""

from __future__ import annotations

import signal

# Ignored signals are inherited: under nohup, and in the background of a script, processes that a test interrupts would
# not hear of it and run on.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
