"""Ids over several models: those of a further model go on where the models before it ended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.outputs import evidence_name
from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import DetectionRow
from core.stage import Facts
from core.task_key import piece_of, stage_of

I32 = NDArray[np.int32]


@dataclass(frozen=True)
class Start:
    """First free ids."""

    defect: int = 0
    event: int = 0

    @classmethod
    def after(cls, facts: Mapping[str, Facts], piece: int) -> Start:
        """Behind the timelines of all models before `piece`, whose facts are given by task key."""
        before = [own for key, own in facts.items() if stage_of(key) == "timeline" and piece_of(key) < piece]
        return cls(sum(int(own["n_defects"]) for own in before), sum(int(own["n_events"]) for own in before))

    def rows(self, rows: Sequence[DetectionRow]) -> list[DetectionRow]:
        """Detections."""
        return [row if row.defect_id is None else replace(row, defect_id=row.defect_id + self.defect) for row in rows]

    def events(self, rows: Sequence[EventRow]) -> list[EventRow]:
        """Events."""
        return [replace(row, event_id=row.event_id + self.event, defect_id=row.defect_id + self.defect) for row in rows]

    def records(self, records: Sequence[DefectRecord]) -> list[DefectRecord]:
        """Defects."""
        return [
            replace(
                record,
                id=record.id + self.defect,
                events=tuple(event + self.event for event in record.events),
                evidence=f"gallery/{evidence_name(record.id + self.defect)}",
            )
            for record in records
        ]

    def vertices(self, defect: I32) -> I32:
        """Defect of every vertex; -1 = none."""
        return np.where(defect >= 0, defect + self.defect, defect).astype(np.int32)
