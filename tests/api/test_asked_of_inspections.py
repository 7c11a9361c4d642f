"""Whatever is asked about inspections and their results, the answer keeps to the document."""

from __future__ import annotations

import pytest

from tests.api.asking import hold_to_the_document
from tests.api.conftest import Backend

pytestmark = pytest.mark.slow


def test_calls_about_inspections(backend: Backend, unprobed: None) -> None:
    hold_to_the_document(backend, of_inspections=True, statuses={200, 202, 204, 404, 409, 422})
