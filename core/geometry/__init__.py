"""Geometry that every stage shares, each concept written once: poses, similarities, lenses, boxes, nearest values.

Nothing here opens a file or knows a stage.
"""
