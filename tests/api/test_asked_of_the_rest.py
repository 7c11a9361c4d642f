"""Whatever is asked about uploads, accounts, keys, webhooks and the service, the answer keeps to the document."""

from __future__ import annotations

import pytest

from tests.api.asking import hold_to_the_document
from tests.api.conftest import Backend

pytestmark = pytest.mark.slow


def test_all_other_calls(backend: Backend, unprobed: None) -> None:
    hold_to_the_document(backend, of_inspections=False, statuses={200, 201, 204, 404, 409, 412, 422})
