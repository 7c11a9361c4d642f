"""Sparse reconstruction: COLMAP models from the verified view graph."""
