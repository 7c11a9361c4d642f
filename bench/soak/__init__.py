"""Soak: jobs through a whole deployment while its processes are killed, frozen and emptied at random."""
