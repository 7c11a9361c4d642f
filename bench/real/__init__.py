"""Clips that nobody here made, with the poses that others measured: the product beside COLMAP as a user runs it."""
