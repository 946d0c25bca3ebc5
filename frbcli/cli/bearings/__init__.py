"""What is printed of bearings and their films."""
