"""The two views for people: boxes on frames, and the coloured surface."""
