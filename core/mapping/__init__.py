"""Detections of the image plane placed on the surface."""
