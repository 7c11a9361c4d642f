"""What a child process that reads strangers' files gets of this process's environment: a list of what is allowed.

Everything else stays behind, whatever it is called: settings of the service, the database, the broker, object
stores and clouds all keep their credentials in variables.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

_ALLOWED = frozenset(
    {
        # where programs, libraries and modules are
        *("PATH", "LD_LIBRARY_PATH", "LD_PRELOAD", "PYTHONHOME", "PYTHONPATH", "VIRTUAL_ENV"),
        # how Python behaves
        *("PYTHONDONTWRITEBYTECODE", "PYTHONFAULTHANDLER", "PYTHONIOENCODING", "PYTHONPYCACHEPREFIX", "PYTHONUTF8"),
        *("PYTHONWARNINGS", "PYTHONMALLOC", "MALLOC_ARENA_MAX"),
        # language, time zone, folders; numba and torch keep caches in the user's folder
        *("LANG", "LANGUAGE", "TZ", "HOME", "USER", "LOGNAME", "TMPDIR", "TEMP", "TMP", "XDG_CACHE_HOME", "TORCH_HOME"),
        # which GPUs, and how they compute
        *("NVIDIA_VISIBLE_DEVICES", "NVIDIA_DRIVER_CAPABILITIES", "NVIDIA_TF32_OVERRIDE", "CUBLAS_WORKSPACE_CONFIG"),
        *("PYTORCH_ALLOC_CONF", "PYTORCH_CUDA_ALLOC_CONF"),
    }
)
_ALLOWED_BEGINNINGS = ("LC_", "OMP_", "GOMP_", "KMP_", "OPENBLAS_", "MKL_", "NUMBA_", "CUDA_", "OPENCV_")
_SECRET = re.compile("KEY|TOKEN|SECRET|PASSW|CREDENTIAL|AUTH")
"""Even under an allowed beginning a name with such a word stays behind."""
_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


def child_environment(threads: int, environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Environment of a child: what is allowed of `environment`, `threads` threads, and this program importable."""
    allowed = {name: value for name, value in environment.items() if _is_allowed(name)}
    root = str(Path(__file__).resolve().parent.parent)
    known = allowed.get("PYTHONPATH")
    return {
        **allowed,
        **dict.fromkeys(_THREADS, str(threads)),
        "PYTHONPATH": f"{root}{os.pathsep}{known}" if known else root,
        "PYTHONHASHSEED": "0",
        "PYTHONUNBUFFERED": "1",
    }


def _is_allowed(name: str) -> bool:
    return (name in _ALLOWED or name.startswith(_ALLOWED_BEGINNINGS)) and not _SECRET.search(name)
