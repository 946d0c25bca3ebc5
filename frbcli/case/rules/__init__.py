"""Rules that tie several keys together, and their faults."""
