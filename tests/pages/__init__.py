"""Programs that write pages of the documents and the references of the hard cases; tests hold the pages to them."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "helpers"))  # as pytest has it
