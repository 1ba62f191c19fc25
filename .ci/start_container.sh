#!/bin/sh
# Start a student's container: copy the notebooks into the home folder, without overwriting work that is
# there, then run the given command.  "lab" starts JupyterHub's server for one user if a hub started the
# container, and otherwise JupyterLab with a token.
# WITHOUT_NOTEBOOKS=1 copies no notebooks, for a hub that hands them out itself.
set -eu
[ -n "${WITHOUT_NOTEBOOKS:-}" ] || for each in "$(dirname "$0")"/assignments/*; do
  here="$HOME/assignments/$(basename "$each")"
  [ -e "$here" ] || { mkdir -p "$HOME/assignments" && cp -r "$each" "$here"; }
done
[ "$1" = lab ] || exec "$@"
shift
[ -z "${JUPYTERHUB_API_TOKEN:-}" ] || exec jupyterhub-singleuser "$@"
exec jupyter lab --ip=0.0.0.0 --no-browser "$@"
