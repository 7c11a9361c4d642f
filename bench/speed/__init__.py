"""How fast the parts are, each beside the usual way of doing it, in one process and one run."""
