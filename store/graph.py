"""The stage graph as the plan sees it: `core.graph`, or another one in tests."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from core.errors import BadInput
from core.fingerprint import task_fingerprint
from core.graph import TaskSpec, expand
from core.products.contract import Facts
from core.settings import Settings, declared_values
from core.stage_specs import STAGES, StageSpec
from core.videos import input_role
from core.weight_files import weights_digest
from store.records import InputFiles

NO_RESULT = "none"
"""Stands in a fingerprint for a dependency without a result."""


@dataclass(frozen=True)
class Graph:
    """Stages and how a run unfolds into tasks."""

    stages: Mapping[str, StageSpec]
    expand: Callable[[Settings, Mapping[str, Facts]], Sequence[TaskSpec]]
    serves_from: tuple[str, ...] = ()
    """Once one of these stages has succeeded a later failure leaves something worth serving (`partial`)."""

    def fingerprint(
        self,
        task: TaskSpec,
        settings: Settings,
        digests: Mapping[str, str],
        files: Sequence[InputFiles],
    ) -> str:
        """Name of the result of `task`; `digests` holds those of its dependencies that have a result."""
        spec = self.stages[task.stage]
        inputs = {key: digests.get(key, NO_RESULT) for key in task.depends}
        for number, one in enumerate(files):
            if spec.reads_video:
                inputs[f"input:{input_role('video', number)}"] = one.video_sha256
            if spec.reads_annotations:
                inputs[f"input:{input_role('annotations', number)}"] = one.annotations_sha256 or NO_RESULT
        inputs.update({f"weights:{name}": weights_digest(name) for name in spec.weights})
        chosen = declared_values(settings, spec.settings)
        return task_fingerprint(task.stage, spec.version, chosen, dict(task.args), inputs)


CORE_GRAPH = Graph(STAGES, expand, serves_from=("reduce_coarse",))
"""What every inspection runs. A reducer that succeeded has named a case with a model."""


def load_graph(name: str) -> Graph:
    """The graph that ``module:name`` names; `BadInput` when there is none."""
    module, _, attribute = name.partition(":")
    try:
        graph = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise BadInput(f"there is no stage graph '{name}': {error}", where="BLADEATLAS_GRAPH") from error
    if not isinstance(graph, Graph):
        raise BadInput(f"'{name}' is no stage graph", where="BLADEATLAS_GRAPH")
    return graph
