"""The time loop: advances rotor and films together. Knows neither cases nor files."""
