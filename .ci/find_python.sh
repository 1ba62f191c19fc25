#!/bin/sh
# Print a Python 3.11, or say how to get one.
for name in "${PYTHON:-}" python3.11 python3 python "$(uv python find --system 3.11 2>/dev/null)"; do
  [ -n "$name" ] || continue
  if "$name" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
    command -v "$name"
    exit 0
  fi
done
cat >&2 <<'END'
This course needs Python 3.11, for which PyBullet's newest wheels are made. Get it with one of these, then
try again:
  Debian 12                     sudo apt-get install -y python3.11-venv
  anywhere                      uv python install 3.11           (uv comes with: pipx install uv)
  with conda or micromamba      micromamba create -f .ci/environment.yml && micromamba activate baxter-lab
  one that you have already     export PYTHON=/path/to/python3.11
END
exit 1
