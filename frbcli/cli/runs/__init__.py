"""Run-up and run-down; pictures, tables and pages of a run."""
