"""Parameter studies: one case with many settings."""
