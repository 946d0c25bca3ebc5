"""Many runs of one case: compare, accuracy, verify, sweep, hard cases."""
