"""Annotations in: refused with the place of the mistake, or understood and put on exact frames."""
