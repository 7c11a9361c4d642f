"""Lenses that were measured: files of calibrations, and calibration from a video of a board."""
