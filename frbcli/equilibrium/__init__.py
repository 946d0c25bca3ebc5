"""Where a machine rests at a speed, with the speeds of its rings and its temperatures; coefficients of its films."""
