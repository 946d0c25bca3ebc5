"""How films are computed and surfaces touch; laws and bearing models of one's own."""
