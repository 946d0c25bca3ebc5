"""Static equilibria, stability, natural modes."""
