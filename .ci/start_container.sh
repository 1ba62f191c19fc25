#!/bin/sh
# Start of a student's container: lay the notebooks into the home, never over work that is there, then
# run the command given; "lab" is Jupyter, a hub's where a hub started us, else one with a token.
# WITHOUT_NOTEBOOKS=1 is for a hub that hands them out by itself.
set -eu
[ -n "${WITHOUT_NOTEBOOKS:-}" ] || for each in "$(dirname "$0")"/assignments/*; do
  here="$HOME/assignments/$(basename "$each")"
  [ -e "$here" ] || { mkdir -p "$HOME/assignments" && cp -r "$each" "$here"; }
done
[ "$1" = lab ] || exec "$@"
shift
[ -z "${JUPYTERHUB_API_TOKEN:-}" ] || exec jupyterhub-singleuser "$@"
exec jupyter lab --ip=0.0.0.0 --no-browser "$@"
