"""What a task may use of its machine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from core.confinement import ProcessLimits
from core.states import Queue

if TYPE_CHECKING:  # every process of a task loads this module, and none of them the database
    from store.settings import DeploymentSettings


@dataclass(frozen=True)
class TaskLimits:
    """Limits on one task; beyond them it is ended and not tried again. Without values nothing is limited."""

    resident_bytes: int = 0
    """Memory that its processes have together; looked at a few times a second. 0 = none."""
    seconds: float = math.inf
    """Of the clock."""
    address_bytes: int = 0
    """Address space of each process, held by the kernel; 0 = none."""
    cpu_seconds: float = 0.0
    """Processor time of each process; 0 = `seconds` on each of its threads, which the clock ends first."""
    file_bytes: int = 0
    """Largest file; 0 = none."""

    @staticmethod
    def of(settings: DeploymentSettings) -> TaskLimits:
        """The limits of a deployment."""
        return TaskLimits(
            settings.task_memory_bytes,
            settings.task_seconds,
            settings.task_address_bytes,
            settings.task_cpu_seconds,
            settings.task_file_bytes,
        )

    def of_process(self, queue: Queue, threads: int) -> ProcessLimits:
        """What the kernel holds a stage with so many threads to.

        A driver of GPUs reserves more addresses than any machine has memory, so tasks that may use one have no limit
        on them.
        """
        cpu_s = self.cpu_seconds or self.seconds * threads
        return ProcessLimits(
            address_bytes=0 if queue == Queue.GPU else self.address_bytes,
            cpu_s=0 if math.isinf(cpu_s) else math.ceil(cpu_s),
            file_bytes=self.file_bytes,
        )
