# One target for each task of this project; `make help` lists them.
.DEFAULT_GOAL := help
SHELL := /bin/sh
BIN := .venv/bin
# uv installs in seconds what takes pip minutes; pip fetches uv.
PIN := --constraint constraints.txt
PIP = $(BIN)/pip install --quiet --disable-pip-version-check $(PIN)
UV = $(BIN)/uv pip
INSTALL = $(UV) install --quiet --system-certs $(PIN)
# Things that Debian's packages supply: for students, for graders and for tests.
FOR_ALL := ensurepip.py:python3-venv libgomp.so.1:libgomp1
FOR_GRADING := $(FOR_ALL) bwrap:bubblewrap libseccomp.so.2:libseccomp2
FOR_TESTS := $(FOR_GRADING) node:nodejs libatomic.so.1:libatomic1
# Ubuntu's Chromium is a snap, which programs cannot control; there Playwright installs its own.
FOR_TESTS += $(shell grep -qs '^ID=debian' /etc/os-release && echo chromium,google-chrome:chromium)
AS_ROOT = $(filter 0,$(shell id -u))
# Systems for which `make lock` looks for wheels of all that students need.
SYSTEMS := x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu aarch64-apple-darwin x86_64-apple-darwin windows
# A newer Python, with neither PyBullet nor Pinocchio: MuJoCo moves the arm and computes its model.
SECOND := .venv-313/bin
# Modules that the installation left uncompiled are compiled at their first import.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo test dev soak lab book vendor campaign record tag-bench count lint lock clean

help: ## list the targets
	@grep -hE '^[a-z0-9-]+:.*##' $(MAKEFILE_LIST) | awk -F':.*## ' '{printf "  make %-16s %s\n", $$1, $$2}'

demo: for-grading .venv/.course ## make a release, grade a small class, build the book and say where to look
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python .ci/demo.py

test: for-tests .venv/.dev browser .venv-313/.made lint ## the gate: style, types, a newer Python, all tests but the soak
	@begun=$$(date +%s); \
	$(SECOND)/python -m pytest -q -n 2 -m "not slow and not soak and not pybullet" tests/test_*.py tests/sim tests/tags \
	&& $(SECOND)/python -m pytest -q -n 2 tests/notebooks/test_always_runs.py -k "all and (00 or 03 or 05)" \
	&& echo "Python 3.13: $$(($$(date +%s) - begun)) s"
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --dist loadgroup --no-loadscope-reorder

dev: for-all .venv/.dev ## make the environment, .venv, and nothing else

soak: for-tests .venv/.dev browser .venv-313/.made ## what the gate leaves out: attacks, kills, a large class, one verdict, all pages
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --dist loadgroup --no-loadscope-reorder -m soak
	@$(SECOND)/python -m pytest -q -n 2 -k "runs_to_the_end or test_live" tests/notebooks/test_always_runs.py tests/replay/test_live.py
	@$(SECOND)/python -m solutions.study.record --verdicts --check

lab: .venv/.course ## open the notebooks of this checkout; students start theirs from the zip
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/jupyter lab --notebook-dir assignments $(if $(AS_ROOT),--allow-root)

book: .venv/.course ## build the book, book/_build/html/index.html and dist/book.zip; keep its runs, book/runs
	@$(BIN)/python book/_tools/build_book.py --publish

vendor: .venv/.dev ## make the book's browser files again (node 20)
	@sh .ci/need.sh node:nodejs npm:npm
	@PYTHON="$(CURDIR)/$(BIN)/python" sh book/_tools/vendor.sh

campaign: .venv/.course ## run the compared controllers on every task: build/campaign.json
	@$(BIN)/python -m solutions.study

record: .venv/.course ## make all recorded data again, and say which verdicts changed
	@$(BIN)/python -m solutions.study.record

tag-bench: .venv/.course ## measure the tag sensor in 14 kinds of light, beside OpenCV
	@$(BIN)/python -m tests.bench.tags

count: ## count the lines of code, storey by storey, beside their ceilings
	@python3 tests/test_size.py

lint: .venv/.dev ## check style, spelling, who imports whom, and types
	@begun=$$(date +%s); $(MAKE) --silent -j 2 style types windows && echo "style and types: $$(($$(date +%s) - begun)) s"

.PHONY: style types windows
style:
	@$(BIN)/ruff check --quiet . && $(BIN)/ruff format --quiet --check . || { $(BIN)/ruff format --diff . ; exit 1; }
	@said=$$($(BIN)/lint-imports --no-logo --no-cache) || { echo "$$said"; exit 1; }
	@$(BIN)/codespell *.md book labkit solutions tests .ci

types:
	@$(BIN)/mypy --no-error-summary

windows: # a student's code meets no module, name or signal that Windows lacks
	@$(BIN)/mypy --no-error-summary --platform win32 --follow-imports silent --cache-dir .mypy_cache/windows \
	  --exclude labkit/grader labkit

lock: .venv/.dev ## choose the versions in constraints.txt, and look for wheels of what students need
	@$(UV) compile --quiet --system-certs --universal --python-version 3.11.2 --all-extras --no-annotate --no-header \
	  pyproject.toml --output-file constraints.txt
	@echo jupyterlab | $(UV) compile --quiet --system-certs --universal --python-version 3.11.2 --extra notebook \
	  --no-annotate --no-header $(PIN) pyproject.toml - --output-file .ci/student/constraints.txt
	@printf 'uv\njupyterlab' | $(UV) compile --quiet --system-certs --generate-hashes --python-platform $(firstword $(SYSTEMS)) --python-version 3.11 \
	  --only-binary :all: --extra notebook --no-annotate --no-header $(PIN) pyproject.toml - --output-file hashes.txt
	@for system in $(SYSTEMS); do for python in 3.11 3.12 3.13 3.14; do \
	  echo jupyterlab | $(UV) compile --quiet --system-certs --only-binary :all: --extra notebook $(PIN) \
	  --python-platform $$system --python-version $$python pyproject.toml - >/dev/null 2>&1 && said="wheels of all" || said="WHEELS MISSING"; \
	  echo "$$system, Python $$python: $$said"; done; done

clean: ## delete generated files; students' work, marks and hidden cases are kept
	rm -rf .venv .venv-313 dist book/_build book/generated build/[!c]* build/campaign*

# Environments for an instructor and a developer.

.PHONY: for-all for-grading for-tests browser
for-all:
	@sh .ci/need.sh $(FOR_ALL)

for-grading:
	@sh .ci/need.sh $(FOR_GRADING)

for-tests:
	@sh .ci/need.sh $(FOR_TESTS)

browser: .venv/.dev
	@$(BIN)/python book/_tools/chromium.py >/dev/null 2>&1 || $(BIN)/playwright install $(if $(AS_ROOT),--with-deps) chromium

.venv/.made: | for-all
	@echo "making .venv with $$(sh .ci/find_python.sh)"
	@"$$(sh .ci/find_python.sh)" -m venv .venv && $(PIP) uv && touch $@

.venv/.course: .venv/.made pyproject.toml constraints.txt
	@echo "installing what an instructor needs"
	@$(INSTALL) --python $(BIN)/python --compile-bytecode -e '.[book]' && touch $@

.venv/.dev: .venv/.made pyproject.toml constraints.txt
	@echo "installing what a developer needs"
	@$(INSTALL) --python $(BIN)/python -e '.[dev]' && touch .venv/.course $@

.venv-313/.made: .venv/.dev pyproject.toml constraints.txt
	@echo "making .venv-313 with Python 3.13"
	@python=$$(PATH="$$PATH:$(CURDIR)/$(BIN)" sh .ci/find_python.sh 3.13) && "$$python" -m venv --clear --without-pip .venv-313
	@$(INSTALL) --python $(SECOND)/python -e '.[test]'
	@$(UV) uninstall --quiet --python $(SECOND)/python pin && touch $@
