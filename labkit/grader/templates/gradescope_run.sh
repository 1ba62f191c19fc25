#!/bin/sh
# Gradescope runs this for each submission, as root.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 XDG_CACHE_HOME="${XDG_CACHE_HOME:-/opt/labkit/cache}"
exec "${LABKIT_PYTHON:-/opt/labkit/bin/python}" -P -m labkit.grader.gradescope "$@"
