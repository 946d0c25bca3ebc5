"""Hard cases, each in a process of its own."""
