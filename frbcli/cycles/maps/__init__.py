"""Stability maps: curves of Hopf points and folds over two numbers."""
