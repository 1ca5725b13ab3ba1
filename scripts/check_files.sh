#!/usr/bin/env bash
# Opens what nmt writes with other tools: mesh.msh by Gmsh and meshio, mesh.vtu and nodes.csv by meshio and numpy (PyPI).
# Needs python3 and the package index on the first run; everything stays in target/ but system libraries that Gmsh lacks.
set -euo pipefail
cd "$(dirname "$0")/.."

nmt=${NMT:-target/debug/nmt}
venv=target/check-files
has() { "$venv/bin/python" -c "import importlib.util as u, sys; sys.exit(u.find_spec('$1') is None)" 2>/dev/null; }
if ! [ -x "$venv/bin/python" ] || ! has meshio || ! has gmsh; then
    if ! command -v python3 >/dev/null || ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
        # Debian and Ubuntu keep venv in a package of its own.
        apt-get update -qq && apt-get install -y -qq python3-venv
    fi
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.2.6 gmsh==4.15.2
fi
if ! "$venv/bin/python" -c 'import gmsh' 2>/dev/null; then
    # The wheel brings Gmsh without the system libraries of its windows, which it is linked to even where it opens none.
    apt-get update -qq && apt-get install -y -qq libglu1-mesa libgl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1
fi
exec "$venv/bin/python" -B scripts/check_files.py "$nmt" fixtures/problems target/check-files-out
