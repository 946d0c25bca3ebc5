"""What a run or a test goes through: speed, given motion, start, accuracy and output."""
