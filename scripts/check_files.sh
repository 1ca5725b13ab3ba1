#!/usr/bin/env bash
# Opens what nmt writes with other tools: mesh.vtu and nodes.csv by meshio and numpy (PyPI).
# Needs python3 and the package index on the first run; everything stays in target/.
set -euo pipefail
cd "$(dirname "$0")/.."

nmt=${NMT:-target/debug/nmt}
venv=target/check-files
if ! [ -x "$venv/bin/python" ] || ! "$venv/bin/python" -c 'import meshio' 2>/dev/null; then
    if ! command -v python3 >/dev/null || ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
        # Debian and Ubuntu keep venv in a package of its own.
        apt-get update -qq && apt-get install -y -qq python3-venv
    fi
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.2.6
fi
exec "$venv/bin/python" scripts/check_files.py "$nmt" fixtures/problems target/check-files-out
