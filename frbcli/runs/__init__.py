"""Run-up and run-down from a case to its file, with the stated errors, interruption and resumption."""
