"""The row of equal blades that a surface shows: its axis, pitch, blades, root and tip, and what was seen of them."""
