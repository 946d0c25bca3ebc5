"""The shaft of a case: rigid, Jeffcott and turbocharger are three ways to make a body. Nobody else asks which it is."""
