"""The bare ASGI sink that uploads are compared with: it writes the body to a file and syncs it at the end."""

from __future__ import annotations

import os
import sys
import tempfile
from typing import Any

import uvicorn


async def sink(scope: Any, receive: Any, send: Any) -> None:
    """Take one request's body; nothing is checked, hashed or remembered."""
    if scope["type"] != "http":
        return
    with tempfile.NamedTemporaryFile(dir=os.environ["SINK_FOLDER"]) as file:
        more = True
        while more:
            message = await receive()
            file.write(message.get("body", b""))
            more = message.get("more_body", False)
        file.flush()
        os.fsync(file.fileno())
    await send({"type": "http.response.start", "status": 204, "headers": []})
    await send({"type": "http.response.body", "body": b""})


if __name__ == "__main__":
    uvicorn.run(sink, host="127.0.0.1", port=int(sys.argv[1]), log_level="error")
