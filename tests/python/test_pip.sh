#!/usr/bin/env bash
# pip install from the tree without a network, into an environment of its own, and a law and a run from there.
# Usage: test_pip.sh PYTHON SOURCE_DIR BUILD_DIR
set -euo pipefail
python=$1 source=$2 build=$3
if ! "$python" -c 'import numpy, setuptools, wheel, venv, ensurepip' 2>/dev/null; then
  echo "skipped: no numpy, setuptools, wheel or venv (Debian: python3-numpy python3-setuptools python3-wheel python3-venv)"
  exit 77
fi
work=$(mktemp -d "$build/pip_test.XXXXXX")
trap 'rm -rf "$work"' EXIT
unset SOFTGRAIN_BUILD SOFTGRAIN_PROGRAM PYTHONPATH
"$python" -m venv --system-site-packages "$work/venv"
# An index that is not there: whoever wants to fetch something fails.
PIP_INDEX_URL=http://127.0.0.1:9/ PIP_NO_CACHE_DIR=1 "$work/venv/bin/pip" install -q --no-build-isolation "$source"
cd "$work"
"$work/venv/bin/python" - "$source" <<'PYTHON'
import sys
import softgrain
from softgrain import installation
source = sys.argv[1]
assert installation.program().startswith(sys.prefix), installation.program()
assert installation.laws().__file__.startswith(sys.prefix), installation.laws().__file__
law = softgrain.Law.load(f"{source}/results/published/law.toml")
assert abs(law.force(0.2) / 0.6319459126655842 - 1.0) < 1e-12, law.force(0.2)
assert softgrain.check(f"{source}/pipelines/quickstart.toml").kind == "pipeline"
PYTHON
"$work/venv/bin/softgrain" law eval "$source/results/published/law.toml" --delta 0.2 --json >/dev/null
[[ ! -e "$source/softgrain.egg-info" ]]
