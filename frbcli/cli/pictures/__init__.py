"""Commands that make pictures, tables and pages of a run."""
