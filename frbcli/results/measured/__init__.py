"""Files of measuring instruments: columns of numbers from CSV, WAV, MAT and UFF. Knows no physics."""
