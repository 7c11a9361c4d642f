"""Scores of a result folder against ground truth: one definition for every table."""
