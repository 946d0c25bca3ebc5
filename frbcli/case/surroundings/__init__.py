"""What a rotor stands on and what acts on it besides its bearings."""
