"""Case files and the files that they name, read and written."""
