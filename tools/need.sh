#!/bin/sh
# Make sure that programs are there: sh tools/need.sh PROGRAM[,OTHER]:PACKAGE ...
# As root it installs the Debian packages that are missing; else it prints the one line to run.
missing=""
for pair in "$@"; do
  found=""
  for program in $(echo "${pair%%:*}" | tr ',' ' '); do
    command -v "$program" >/dev/null 2>&1 && found=yes
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
