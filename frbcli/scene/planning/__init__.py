"""The plan of a case: what is modelled, and why."""
