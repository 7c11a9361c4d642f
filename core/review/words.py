"""Words of a review: what can be said, of which kinds of findings, and how far a finding has come."""

from __future__ import annotations

from enum import StrEnum


class Action(StrEnum):
    """What a record says."""

    ACCEPT = "accept"
    REJECT = "reject"
    RELABEL = "relabel"
    """It is of another type."""
    MERGE = "merge"
    """It is the same as another finding, which stays."""
    SPLIT = "split"
    """Some of its detections are a finding of their own, which the record makes."""
    MOVE = "move"
    """It lies elsewhere."""
    SET_BLADE = "set_blade"
    SEVERITY = "severity"
    """What shall be done about it: a human's word only."""
    NOTE = "note"
    MEASURE = "measure"
    """A length that a person measured."""
    ADD = "add"
    """A finding that the detector missed, drawn on a frame; the record makes it."""
    UNDO = "undo"
    """Another record shall not hold."""


class TargetKind(StrEnum):
    """Who made a finding."""

    DEFECT = "defect"
    """The method: a record of defects.json."""
    ADDED = "added"
    """A person, by adding or splitting."""


class ReviewState(StrEnum):
    """How far a finding has come."""

    OPEN = "open"
    ACCEPTED = "accepted"
    REJECTED = "rejected"
    MERGED = "merged"
    """It counts as part of another."""


SEVERITIES = ("serviceable", "monitor", "reject")
"""Severities where nothing else is configured."""
