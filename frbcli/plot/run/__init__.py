"""Pictures of the signals of a run."""
