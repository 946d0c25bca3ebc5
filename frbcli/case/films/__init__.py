"""How films are computed and surfaces touch; user-defined laws and bearing models."""
