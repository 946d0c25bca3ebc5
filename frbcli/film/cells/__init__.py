"""Films on finite-volume cells, compiled for the time loop; tests hold every kernel to its plain form in plain/."""
