#!/bin/sh
# Make the browser files: bundle viewer and live arm, cut the font of formulas, write the manifest.
# Needs node 20 with npm, and a Python with mujoco.  Run from anywhere: sh book/_tools/vendor.sh
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/vendor/package.json" "$work/"
(cd "$work" && npm install --no-package-lock --no-audit --no-fund --ignore-scripts --silent)
python=${PYTHON:-python}
licence=$("$python" -c "import importlib.metadata as m; print(next(f.locate() for f in m.files('mujoco') if f.name.startswith('LICENSE')))")
theme=$("$python" -c "import pydata_sphinx_theme as t, pathlib; print(pathlib.Path(t.__file__).parent / 'theme/pydata_sphinx_theme/static/vendor/fontawesome/webfonts')")
PYTHON=$python node "$here/vendor/build.mjs" "$work/node_modules" "$licence" "$theme"
