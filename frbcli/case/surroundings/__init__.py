"""What a rotor stands on and what acts on it beside its bearings."""
