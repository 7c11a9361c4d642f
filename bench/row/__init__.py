"""The row of blades over scenes of every kind: found where it can be, unknown where it cannot."""
