"""Files that a case names: their numbers take the place of the key `file`."""
