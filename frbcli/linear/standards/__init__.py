"""What standards permit: the unbalance of a rotor by its balance quality grade, its vibration, its critical speeds."""
