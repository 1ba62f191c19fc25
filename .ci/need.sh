#!/bin/sh
# Check that a make target has what it needs: sh .ci/need.sh THING[,OTHER]:PACKAGE ...
# A thing is a program, a library (libNAME.so.N) or a Python module (NAME.py).
# As root, install the Debian packages that are missing; otherwise print the one line to run.
python=.venv/bin/python # if the environment exists, no other Python has to be found
[ -x "$python" ] || python=$(sh "$(dirname "$0")/find_python.sh") || exit 1

there() {
  case "$1" in
    *.py) "$python" -c "import ${1%.py}" 2>/dev/null ;;
    *.so.*) "$python" -c "import ctypes; ctypes.CDLL('$1')" 2>/dev/null ;;
    *) command -v "$1" >/dev/null 2>&1 ;;
  esac
}

missing=""
for pair in "$@"; do
  found=""
  for thing in $(echo "${pair%%:*}" | tr ',' ' '); do
    there "$thing" && found=yes
  done
  [ -n "$found" ] || missing="$missing ${pair##*:}"
done
[ -z "$missing" ] && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
  echo "installing the packages:$missing"
  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null && exit 0
fi
echo "Needed packages are missing. Run this once, then try again: sudo apt-get install -y$missing" >&2
exit 1
