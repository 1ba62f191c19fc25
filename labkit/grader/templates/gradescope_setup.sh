#!/bin/sh
# Gradescope runs this once, as root, to make the image. Python is installed where every user can
# read it. What Gradescope unpacks here contains hidden cases, so only root may read it.
set -e
cd "$(dirname "$0")"
chmod 700 .
apt-get update
apt-get install -y --no-install-recommends python3-venv libgomp1
python3 -m venv /opt/uv
/opt/uv/bin/pip install --quiet uv
export UV_PYTHON_INSTALL_DIR=/opt/python
/opt/uv/bin/uv venv --quiet --python 3.11 /opt/labkit
/opt/uv/bin/uv pip install --quiet --compile-bytecode --python /opt/labkit/bin/python \
  --constraint constraints.txt "$(ls ./labkit-*.whl)[notebook]"
./run_autograder --try
