"""What a run or a test goes through: speed, tables over time, given motion, start, accuracy and output."""
