"""How films are computed and surfaces touch; laws that were added from Python."""
