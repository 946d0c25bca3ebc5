"""Analysis of the signals of a run: spectra, orders, events. Computes no film and launches no run."""
