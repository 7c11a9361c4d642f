"""A probe that takes its time: stands in for `core.intake` where turns and limits are under test."""

from __future__ import annotations

import json
import sys
import time

question = json.load(sys.stdin)
if question["roi"]["x0"] > 0.4:
    from core.intake import limit_process

    limit_process(question["parent"], question["memory_bytes"], question["seconds"])
    while True:  # until its processor time is over
        pass
time.sleep(0.3)
sys.stdout.write("{}")
