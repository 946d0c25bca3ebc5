"""Run-up and run-down: progress, compiling, memory."""
