# SPDX-License-Identifier: Apache-2.0
# There is one command for each job. It first makes the environment that it needs, if that is not there yet.

SHELL := /bin/sh
VENV := .venv
BIN := $(VENV)/bin
MADE := $(VENV)/.made
INSTALL := setup/install.sh $(VENV)

ifneq ($(words $(VENV)),1)
$(error VENV: found '$(VENV)', allowed is a folder without spaces in its name)
endif

# A ROS or a Python environment that the calling shell has sourced must not affect this one.
unexport AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH RMW_IMPLEMENTATION
unexport PYTHONHOME PYTHONPATH VIRTUAL_ENV
# The ROS wheels set this when they have restarted Python with their libraries. If it were inherited, they would not restart.
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE
# A user-wide `pip install --user` as the default does not work inside a virtual environment.
export PIP_USER := 0

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo test test-matrix wheels release-tree test-slow sweeps fuzz coverage lint types bench docs pictures setup venv clean FORCE

help: ## print this
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | while IFS='	' read -r name text; do \
	    printf '  make %-11s  %s\n' "$$name" "$$text"; done
	@echo "  PYTHON=python3.12 chooses the Python (3.10 to 3.14) that $(VENV) is made with."

demo: $(MADE)/package $(MADE)/interfaces ## play a toss and compare predictions with it; VIEW=1 opens the viewer, TOSS=path plays another; SCENE=belt|paddle|stack|grasp opens a scene
	@$(BIN)/$(if $(SCENE),python examples/scenes.py $(SCENE),contact-dynamics demo $(if $(VIEW),--view) $(if $(TOSS),--toss "$(TOSS)"))

# One process more than there are processors, because a quarter of the time goes by in waiting for processes and DDS. More
# than four gain little: the longest files of the nodes' tests wait most.
JOBS ?= $(shell n=$$(nproc 2>/dev/null || echo 1); [ "$$n" -gt 3 ] && n=3; echo $$((n + 1)))
PROCESSES = $(if $(filter-out 1,$(JOBS)),-n $(JOBS) --dist loadfile)
test: lint types $(MADE)/test ## lint, types and the tests; JOBS=1 runs them in one process
	@$(BIN)/python -m pytest $(PROCESSES)

test-matrix: ## the physics with the oldest and newest NumPy and SciPy, on every Python and kind of processor; the nodes on Kilted
	@setup/matrix.sh $(VENV)-matrix

wheels: ## in dist/: wheels of library and interfaces for every Python of this machine or PYTHONS=3.12, a plain one for all platforms, the sdist
	@setup/wheels.sh $(VENV)-wheels

release-tree: ## in dist/release: both packages of the last commit beside each other, as bloom needs them
	@setup/release_trees.sh dist/release

SWEEP ?= test
CERTAINTY := test/contact_modes/spatial/test_no_mode_missed.py test/contact_modes/spatial/test_nearly_the_same.py test/contact_modes/spatial/test_boxes_nearly_flush.py test/toss/test_among_flats.py
test-slow: $(MADE)/test ## the sweeps that are too slow for `make test`; SWEEP=path runs those of one file or folder
	@HYPOTHESIS_PROFILE=explore $(BIN)/python -m pytest -m slow $(SWEEP)

sweeps: $(MADE)/test ## the large sweeps behind docs/certainty.md: modes, nearly equal contacts, tosses
	@$(MAKE) --no-print-directory test-slow SWEEP="$(CERTAINTY)"

fuzz: $(MADE)/test ## ask 10 000 questions of all kinds, with numbers of every size
	@$(BIN)/python -m pytest -q -n 0 -m slow test/questions/test_fuzz.py

coverage: $(MADE)/test ## which lines the tests do not reach, in coverage_html/ too
	@$(BIN)/python -m coverage erase
	@CONTACT_DYNAMICS_PLAIN=1 $(BIN)/python -m coverage run -m pytest -q
	@$(BIN)/python -m coverage combine -q
	@$(BIN)/python -m coverage html -q -d coverage_html
	@$(BIN)/python -m coverage report

lint: $(MADE)/test ## ruff: rules and format
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check --quiet || { $(BIN)/ruff format --diff --quiet; echo 'ruff format puts this right.'; exit 1; }

# Python 3.10 ends at NumPy 2.2, whose own types are too coarse: they say floating where it returns float64.
types: $(MADE)/test ## mypy
	@if $(BIN)/python -c 'import sys; raise SystemExit(sys.version_info < (3, 11))'; then $(BIN)/mypy; \
	else echo 'NOT CHECKED: the types, for which the NumPy of Python 3.11 or newer is needed.'; fi

bench: $(MADE)/bench ## measure speed and accuracy, peers beside us; WRITE=1 renews the numbers in the documents
	@$(BIN)/python -m benchmarks $(if $(WRITE),--write)

# material prints an advertisement for its successor unless this is set.
docs: $(MADE)/test ## the documents as a site with a reference, in site/
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet
	@echo "Open site/index.html in a browser. To search it too: $(BIN)/python -m http.server -d site"

pictures: $(MADE)/test ## the viewer's pictures in docs/, with the moving one of the README
	@$(BIN)/python scripts/viewer_pictures.py

setup: $(MADE)/package $(MADE)/interfaces ## make the environment in .venv and nothing else
venv: setup

clean: ## remove what make made: the environment, the tools' caches, the demo's output
	@setup/clean.sh $(VENV)

# Each file in $(MADE) says that a step is done. Its prerequisites are what makes the step necessary again. Its time is when the
# step began, so that a prerequisite that changes during the step makes it necessary again too.

$(MADE)/python: FORCE
	@setup/make_venv.sh $(VENV) $(if $(filter-out undefined,$(origin PYTHON)),"$(PYTHON)")

RUN := $(addprefix requirements/,core.txt view.txt jazzy.txt build.txt)
$(MADE)/wheels: $(RUN) requirements/constraints.txt $(MADE)/python
	@touch $@.begun
	@echo "Installing ROS 2 Jazzy and what else runs (about 1 GB; a minute or two)."
	@$(INSTALL) -c requirements/constraints.txt $(addprefix -r ,$(RUN))
	@mv $@.begun $@

INTERFACES := contact_dynamics_interfaces
# The folders themselves are listed too, because their time changes when a file is removed.
$(MADE)/interfaces: $(addprefix $(INTERFACES)/,CMakeLists.txt package.xml msg srv) $(wildcard $(INTERFACES)/*/*.msg $(INTERFACES)/*/*.srv) \
                    cmake/wheel_paths.cmake setup/build_interfaces.sh $(MADE)/wheels
	@touch $@.begun
	@setup/build_interfaces.sh $(VENV)
	@mv $@.begun $@

# The package is installed in place, so a change of the sources works at once, unless they are compiled. pip leaves out its data
# files then, so they are linked to where ROS looks for them. They are linked one by one, because `ros2 launch` does not follow
# a linked folder.
SHARE := $(VENV)/share/contact_dynamics
CORE := $(wildcard $(addprefix contact_dynamics/,*.pxd */*.pxd */*/*.pxd))
INDEX := $(VENV)/share/ament_index/resource_index/packages
$(MADE)/package: setup.py package.xml pyproject.toml Makefile $(CORE) $(CORE:.pxd=.py) $(wildcard config launch config/*.yaml config/*.xml launch/*.launch.py) $(MADE)/wheels
	@touch $@.begun
	@$(INSTALL) --no-deps --no-build-isolation --editable .
	@rm -rf $(SHARE)
	@mkdir -p $(SHARE)/config $(SHARE)/launch $(INDEX)
	@ln -sf "$(CURDIR)"/package.xml $(SHARE)/
	@ln -sf "$(CURDIR)"/config/*.yaml "$(CURDIR)"/config/*.xml $(SHARE)/config/
	@ln -sf "$(CURDIR)"/launch/*.launch.py $(SHARE)/launch/
	@ln -sf "$(CURDIR)"/resource/contact_dynamics $(INDEX)/
	@ln -sfn "$(CURDIR)"/executables $(VENV)/lib/contact_dynamics
	@mv $@.begun $@

$(MADE)/test: requirements/test.txt requirements/docs.txt $(MADE)/package $(MADE)/interfaces
	@touch $@.begun
	@echo "Installing what the tests need."
	@$(INSTALL) -c requirements/constraints.txt -r requirements/test.txt -r requirements/docs.txt
	@mv $@.begun $@

$(MADE)/bench: requirements/bench.txt $(MADE)/test
	@touch $@.begun
	@echo "Installing what the benchmarks need."
	@$(INSTALL) -c requirements/constraints.txt -r requirements/bench.txt
	@mv $@.begun $@
