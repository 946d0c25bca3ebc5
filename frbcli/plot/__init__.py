"""Pictures: one per file."""
