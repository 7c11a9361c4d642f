"""Video in: one decoding path, exact times, one frame table."""
