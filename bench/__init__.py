"""Evaluation against ground truth and speed beside other programs."""
