.DEFAULT_GOAL := help
.PHONY: help setup qgis-setup test test-all test-thorough test-core test-elsewhere test-plugin test-qgis344 test-qgis340 fuzz lint format demo qgis screenshots translations package clean

# QGIS's own, for what needs nothing else; that of the tests' environment has pytest, the linters and the rest.
QGIS_PYTHON := /usr/bin/python3
PYTHON := .venv/bin/python
# Seconds after which a run inside QGIS is stopped, with the stacks of all threads printed: for one that hangs.
PLUGIN_TIMEOUT := 3600
DEMO_TIMEOUT := 1200

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

setup:  ## install what is missing for everything: QGIS from the distribution, then .venv for the tests
	@bash tools/setup.sh tests

qgis-setup:
	@bash tools/setup.sh

# The core's tests keep a processor busy while those in QGIS wait for windows and timers. Four parts at a time, taken in
# this order, keep two processors busy to the end; each collects its own files alone. The output of each part comes in
# one piece, when it ends.
PARTS := plugin-[a-c] core-capture plugin-[d-o] core-mission plugin-[p-s] core-command plugin-[t-z] core-imagery core-others
capture := tests/core/capture
mission := tests/core/mission
command := $(wildcard tests/test_*.py tests/core/test_*.py) tests/fuzz
imagery := tests/core/imagery tests/core/dataset
# Rooms that are new are among these.
others := $(filter-out $(capture) $(mission) $(imagery) %/__pycache__,$(patsubst %/,%,$(wildcard tests/core/*/)))
# Threads of numpy's and PyTorch's own would wait for each other in loops there.
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1
CORE_TESTS := tests --ignore=tests/plugin
TEST_CORE = $(PYTHON) -m pytest $(1) -m "not thorough"
TEST_PLUGIN = $(PYTHON) tools/qgis_app.py --timeout $(PLUGIN_TIMEOUT) --pytest $(1) -m "not thorough"

test: setup translations  ## every test: core headless, beside it plugin inside the real QGIS
	@echo "core and plugin are tested side by side, in parts, which report when they end"
	@$(MAKE) --no-print-directory --jobs=4 --keep-going --output-sync=target $(PARTS:%=test-%)

test-all: test test-thorough  ## these, and many more cases and examples of what they prove of a few

test-thorough: setup translations
	TERRAINAV_EXAMPLES=all $(PYTHON) -m pytest $(CORE_TESTS) -m "thorough or hypothesis"
	$(PYTHON) tools/qgis_app.py --timeout $(PLUGIN_TIMEOUT) --pytest tests/plugin -m thorough

test-core: setup  ## only the tests that run without Qt and QGIS
	$(call TEST_CORE,$(CORE_TESTS))

test-core-%:
	$(call TEST_CORE,$($*))

# What holds must hold with the newest numpy, and on processors that have less than this one, whose sines are others.
ELSEWHERE := .venv/newest/bin/python
NARROW = NPY_DISABLE_CPU_FEATURES="$$($(ELSEWHERE) -c 'from tests.support.libraries import chosen_instructions as all; print(*all())')"
NUMERIC_TESTS := tests/core/geodesy tests/core/mission tests/core/report tests/core/poses tests/core/dataset

test-elsewhere: setup  ## what computes, with the newest numpy and Pillow, and without what numpy takes of this processor alone
	@bash tools/setup.sh newest
	$(NARROW) $(ELSEWHERE) -m pytest $(NUMERIC_TESTS) -m "not thorough"
	$(NARROW) $(ELSEWHERE) -m pytest tests/core/capture/test_same_everywhere.py

test-plugin: setup translations  ## only the tests that run inside the real QGIS
	$(call TEST_PLUGIN,tests/plugin)

test-plugin-%:
	$(call TEST_PLUGIN,tests/plugin/test_$**.py)

test-qgis344:  ## the plugin's tests in QGIS 3.44, in a Debian 13 system of its own (root, 2.4 GB)
	@bash tools/debian13.sh 3.44

test-qgis340:  ## the same in the QGIS 3.40 of Debian 13
	@bash tools/debian13.sh 3.40

fuzz: setup  ## attack what reads foreign texts for TERRAINAV_FUZZ_S seconds (600), with new examples every time
	$(PYTHON) -m tests.fuzz

lint: setup translations  ## ruff, mypy (strict on core), bandit; the dependencies' known vulnerabilities, where they can be had
	$(PYTHON) -m ruff check .
	$(PYTHON) -m ruff format --check .
	$(PYTHON) -m mypy
	$(PYTHON) -m bandit --quiet --configfile pyproject.toml --recursive tools
	$(PYTHON) tools/package.py --working-tree --folder build/lint  # bandit and detect-secrets search what is shipped
	$(PYTHON) tools/audit.py

format: setup  ## let ruff rewrite the code
	$(PYTHON) -m ruff check --fix .
	$(PYTHON) -m ruff format .

demo: translations  ## the main job in the real QGIS; leaves demo/ with dataset, project and screenshot
	$(QGIS_PYTHON) tools/qgis_app.py --timeout $(DEMO_TIMEOUT) tools/demo.py

qgis: translations  ## open QGIS with the plugin, in a profile of its own
	$(QGIS_PYTHON) tools/qgis_app.py --visible

screenshots: translations  ## take the pictures of docs/guide.md anew
	$(QGIS_PYTHON) tools/qgis_app.py --timeout $(DEMO_TIMEOUT) tools/screenshots.py

translations: qgis-setup  ## compile what the plugin says in other languages; after a change of texts: tools/translations.py update
	@$(QGIS_PYTHON) tools/translations.py compile

package: translations  ## the zip for QGIS and plugins.qgis.org, of the last commit, in dist/
	$(QGIS_PYTHON) tools/package.py

clean:  ## remove everything that was made here, the environment included
	rm -rf .venv .qgis-profile .hypothesis .mypy_cache .pytest_cache .ruff_cache build dist demo screenshots *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
