#!/bin/sh
# Print the path of a Python, or say how to get one: sh .ci/find_python.sh [VERSION], 3.11 by default.
# If there is none and uv is installed, uv fetches one.
version=${1:-3.11}
pyenv=${PYENV_ROOT:-$HOME/.pyenv}/versions

is_it() {
  [ -n "$1" ] && "$1" -c "import ssl, sys; sys.exit('%d.%d' % sys.version_info[:2] != '$version')" 2>/dev/null
}

for name in "${PYTHON:-}" "python$version" python3 python "$pyenv/$version".*/bin/python3 \
  "$(uv python find --system "$version" 2>/dev/null)"; do
  is_it "$name" && command -v "$name" && exit 0
done
if command -v uv >/dev/null 2>&1 && uv python install --quiet "$version" >&2; then
  name=$(uv python find --system "$version" 2>/dev/null)
  is_it "$name" && echo "$name" && exit 0
fi
cat >&2 <<END
Python $version is needed and was not found. Get it with one of these, then try again:
  Debian 12 (3.11), 13 (3.13)   sudo apt-get install -y python$version-venv
  Ubuntu, and anywhere else     uv python install $version           (uv comes with: pipx install uv)
  with pyenv                    pyenv install $version
  one that you have already     export PYTHON=/path/to/python$version
END
exit 1
