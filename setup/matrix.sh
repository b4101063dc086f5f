#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the suite's physics with the oldest and the newest NumPy and SciPy, on every Python of this machine, and with the newest
# wheels as if on several kinds of processors. Then it runs the tests of the nodes on the wheels of another ROS. Prints a table;
# fails where anything failed or could not be set up.
# usage: matrix.sh FOLDER
#   PYTHONS="3.10 3.13"     only these
#   WHEELS=newest           only these of NumPy and SciPy (oldest, newest), or none
#   PROCESSORS=own          only the processor of this machine as it is
#   ROS=""                  no other ROS (kilted)
#   TESTS="test/impact"     only these files or folders
set -u

folder=$1
here=$(dirname "$0")
tests=${TESTS:-test}
# What needs ROS, rerun, Matplotlib or the built environment is not physics. test/test_setup/test_matrix.py holds that nothing else does.
beside="nodes demo recording replay viewing plots msg_adapters evaluation test_setup architecture"
beside="$beside monitoring/test_live.py monitoring/test_monitor.py test_examples.py test_document_types.py test_quoted_numbers.py test_site.py cases/test_page.py questions/test_bodies_contact_modes.py questions/test_services.py questions/test_warnings.py test_lecture_figures.py test_notebooks.py test_public_names.py"
ros_tests="test/nodes test/recording test/replay test/demo test/msg_adapters"
# pytest-xdist is one of them. The others compile the core.
tools="$(grep -E '^(pytest|hypothesis|mpmath)\b' requirements/test.txt) $(grep -E '^(cython|setuptools)\b' requirements/build.txt)"

mkdir -p "$folder"
jobs=$(nproc 2>/dev/null || echo 1)
table=$folder/table.txt
missing=$folder/missing.txt
: >"$table"
pythons=$("$here/pythons.sh" 2>"$missing")
failed=0

wheels_of() {
    "$1/bin/python" -c 'import numpy, scipy; print("NumPy", numpy.__version__, "SciPy", scipy.__version__)'
}

row() { # Python, wheels, processor, result
    printf '%-7s %-7s %-28s %-12s %s\n' "$1" "$2" "$3" "$4" "$5" >>"$table"
    printf '%s %s %s %s: %s\n' "$1" "$2" "$3" "$4" "$5"
}

run_tests() { # environment, Python, wheels, processor, tests
    log=$1/.made/suite-$4.log
    # The lists are split into words on purpose.
    # shellcheck disable=SC2086
    if "$1/bin/python" -m pytest -q -n "$jobs" --dist loadfile -p no:cacheprovider $5 >"$log" 2>&1; then
        row "$2" "$3" "$(wheels_of "$1")" "$4" "$(tail -n 1 "$log")"
    else
        failed=1
        grep -E '^(FAILED|ERROR)' "$log"
        row "$2" "$3" "$(wheels_of "$1")" "$4" "FAILED: $(tail -n 1 "$log"), see $log"
    fi
}

run_suite() { # environment, Python, which wheels, processor
    ignored=""
    for each in $beside; do ignored="$ignored --ignore=test/$each"; done
    [ "$4" = own ] && unset OPENBLAS_CORETYPE || export OPENBLAS_CORETYPE="$4"
    run_tests "$@" "$ignored $tests"
    unset OPENBLAS_CORETYPE
}

install() { # environment, program, which wheels
    "$here/make_venv.sh" "$1" "$2" || return 1
    case $3 in
        oldest) wanted="-r requirements/oldest.txt" ;;
        newest) wanted="--upgrade numpy scipy" ;;
    esac
    # shellcheck disable=SC2086
    "$here/install.sh" "$1" --only-binary numpy,scipy -r requirements/core.txt $tools $wanted &&
        "$1/bin/python" setup.py -q build_ext --inplace
}

install_ros() { # environment, program, which ROS
    "$here/make_venv.sh" "$1" "$2" || return 1
    "$here/install.sh" "$1" -r "requirements/$3.txt" -r requirements/core.txt -r requirements/view.txt -r requirements/test.txt &&
        "$1/bin/python" -m pip -q install --no-deps --no-build-isolation --editable . &&
        "$here/build_interfaces.sh" "$1"
}

# OpenBLAS picks its kernels by the processor; these it can be told to take, where the processor has their instructions.
processors="Prescott Nehalem"
for pair in avx:Sandybridge avx2:Haswell avx2:Zen avx512f:SkylakeX; do
    if grep -qwm 1 "${pair%%:*}" /proc/cpuinfo; then processors="$processors ${pair##*:}"; fi
done

newest=""
while IFS='	' read -r version program; do
    [ -n "$version" ] || continue
    for wheels in ${WHEELS-oldest newest}; do
        environment=$folder/$version-$wheels
        if install "$environment" "$program" "$wheels"; then
            run_suite "$environment" "$version" "$wheels" own
            [ "$wheels" = newest ] && newest=$environment && newest_version=$version
        else
            failed=1
            row "$version" "$wheels" "" "" "FAILED: not installed"
        fi
    done
done <<END
$pythons
END

if [ -n "$newest" ] && [ "${PROCESSORS:-all}" = all ]; then
    for processor in $processors; do
        run_suite "$newest" "$newest_version" newest "$processor"
    done
fi
for ros in ${ROS-kilted}; do
    environment=$folder/$ros
    program=$(printf '%s\n' "$pythons" | head -n 1 | cut -f 2)
    if install_ros "$environment" "$program" "$ros"; then
        run_tests "$environment" "$("$program" -c 'import sys; print("%d.%d" % sys.version_info[:2])')" "$ros" own "$ros_tests"
    else
        failed=1
        row "" "$ros" "" "" "FAILED: not installed"
    fi
done
if [ ! -s "$table" ]; then
    failed=1
    echo "No Python could be tried." >&2
fi

echo
printf '%-7s %-7s %-28s %-12s %s\n' Python wheels versions processor result
cat "$table"
cat "$missing"
exit $failed
