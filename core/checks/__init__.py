"""Checks that tell when a model must not be trusted: pure functions that give flags."""
