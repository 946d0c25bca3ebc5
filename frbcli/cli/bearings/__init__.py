"""Commands for bearings and their films."""
