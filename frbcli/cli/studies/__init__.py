"""Many runs, and measured ones."""
