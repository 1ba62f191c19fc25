#!/bin/sh
# Print the path of a Python, or say how to get one: sh .ci/find_python.sh [VERSION]; without a version
# 3.11, with which the gate runs, or else 3.12 or 3.13.  If there is none and uv is installed, uv fetches it.
versions=${1:-3.11 3.12 3.13}
pyenv=${PYENV_ROOT:-$HOME/.pyenv}/versions

is_it() {
  [ -n "$1" ] && "$1" -c "import ssl, sys; sys.exit('%d.%d' % sys.version_info[:2] != '$version')" 2>/dev/null
}

for version in $versions; do
  for name in "${PYTHON:-}" "python$version" python3 python "$pyenv/$version".*/bin/python3 \
    "$(uv python find --system "$version" 2>/dev/null)"; do
    is_it "$name" && command -v "$name" && exit 0
  done
done
version=${versions%% *}
if command -v uv >/dev/null 2>&1 && uv python install --quiet "$version" >&2; then
  name=$(uv python find --system "$version" 2>/dev/null)
  is_it "$name" && echo "$name" && exit 0
fi
cat >&2 <<END
Python $versions is needed and was not found. Get it with one of these, then try again:
  Debian, Ubuntu                sudo apt-get install -y python3-venv
  anywhere else                 uv python install $version           (uv comes with: pipx install uv)
  with pyenv                    pyenv install $version
  one that you have already     export PYTHON=/path/to/python$version
END
exit 1
