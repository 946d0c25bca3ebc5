"""Films whose developed gap is made of rectangles: closed forms, tables, chains between axial grooves."""
