"""What the signals of a run say: spectra, orders, events. Computes no film and launches no run."""
