#!/bin/sh
# Print a Python 3.11, or say in one line where to get it.
for name in "${PYTHON:-}" python3.11 python3 python; do
  [ -n "$name" ] || continue
  if "$name" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
    command -v "$name"
    exit 0
  fi
done
echo "This course needs Python 3.11, for which PyBullet's newest wheels are made; get it with: apt-get install python3.11-venv (Debian 12), or: uv python install 3.11 && export PYTHON=\$(uv python find 3.11)" >&2
exit 1
