"""The machine as the equations of cycles take it."""
