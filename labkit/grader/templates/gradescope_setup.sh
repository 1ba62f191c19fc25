#!/bin/sh
# Gradescope runs this once, as root, to make the image. Python is installed where every user can
# read it. What Gradescope unpacks here contains hidden cases, so only root may read it.
set -e
cd "$(dirname "$0")"
chmod 700 .
apt-get update
apt-get install -y --no-install-recommends python3-venv libgomp1 libseccomp2
python3 -m venv /opt/uv
sed -n '/^uv==/,/[^\\]$/p' hashes.txt > uv.txt
/opt/uv/bin/pip install --quiet --require-hashes --requirement uv.txt
export UV_PYTHON_INSTALL_DIR=/opt/python
/opt/uv/bin/uv venv --quiet --python 3.11 /opt/labkit
install="/opt/uv/bin/uv pip install --quiet --compile-bytecode --python /opt/labkit/bin/python"
$install --require-hashes --requirement hashes.txt
$install --no-deps ./labkit-*.whl
