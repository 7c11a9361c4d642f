"""Sizes of findings on the reconstructed surface, and the scale that turns model units into millimetres."""
