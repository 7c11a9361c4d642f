"""Placed detections grouped into defects and events."""
