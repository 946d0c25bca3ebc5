"""Case files: checked, listed, described to editors."""
