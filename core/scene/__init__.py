"""What a run is about, one frozen type per concept: detections, frames, views, cases, events and defects. No files."""
