# One target for each task of this project; `make help` lists them.
.DEFAULT_GOAL := help
SHELL := /bin/sh
BIN := .venv/bin
INSTALL = $(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt
# Things that Debian's packages supply: for students, for graders and for tests.
FOR_ALL := ensurepip.py:python3.11-venv libgomp.so.1:libgomp1
FOR_GRADING := $(FOR_ALL) bwrap:bubblewrap
FOR_TESTS := $(FOR_GRADING) node:nodejs libatomic.so.1:libatomic1
# Ubuntu's Chromium is a snap, which programs cannot control; there Playwright installs its own.
FOR_TESTS += $(shell grep -qs '^ID=debian' /etc/os-release && echo chromium,google-chrome:chromium)
AS_ROOT = $(filter 0,$(shell id -u))
SEED ?= 2019
ASSIGNMENT ?= 01_paths
# A newer Python, for which PyBullet has no wheels, so MuJoCo moves the arm there.
SECOND := .venv-313/bin
ON_SECOND := -m "not slow and not soak and not pybullet"

.PHONY: help demo test test-313 zip dev quick soak count record lab release grade book book-zip book-pdf film vendor campaign campaign-engines bench tag-bench report-card doctor lint types format clean

help: ## list the targets
	@grep -hE '^[a-z0-9-]+:.*##' $(MAKEFILE_LIST) | awk -F':.*## ' '{printf "  make %-16s %s\n", $$1, $$2}'

demo: for-grading .venv/.course ## make a release, grade a small class, build the book and say where to look
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python .ci/demo.py

test: for-tests .venv/.dev browser lint types test-313 ## everything: style, types, all tests and a second Python
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --dist loadgroup --no-loadscope-reorder

test-313: .venv-313/.made ## on Python 3.13 without PyBullet: the lab, the course, Run All, a report card
	@$(SECOND)/python -m labkit report-card --draws 1 --to build/report-card-313 & card=$$!; \
	$(SECOND)/python -m pytest -q -n 2 $(ON_SECOND) tests/test_*.py tests/sim tests/tags tests/course \
	&& $(SECOND)/python -m pytest -q -n 2 $(ON_SECOND) tests/notebooks/test_always_runs.py -k "all or none"; \
	tests=$$?; wait $$card && exit $$tests

dev: for-all .venv/.dev ## make the environment, .venv, and nothing else

quick: for-all .venv/.dev ## the quick tests of the lab and the course, which need only Python
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --quick -m "not slow and not soak" --ignore tests/grader --ignore tests/book --ignore tests/replay --ignore tests/soak

soak: for-tests .venv/.dev browser ## what the gate leaves out: all fuzz tests, attacks, kills, large classes and pages
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n 2 --dist loadgroup --no-loadscope-reorder -m soak

lab: .venv/.student ## open the notebooks of this checkout; students start theirs from the zip
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/jupyter lab --notebook-dir assignments $(if $(AS_ROOT),--allow-root)

zip: .venv/.course ## what students get: dist/baxter-lab.zip
	@$(BIN)/labkit student-bundle

release: .venv/.course ## make the students' notebooks; SEED=n draws other hidden cases
	@$(BIN)/labkit release $(if $(filter command line environment,$(origin SEED)),--seed $(SEED))

grade: for-grading .venv/.course ## grade the notebooks in submitted/; ASSIGNMENT=01_paths
	@$(BIN)/labkit grade $(ASSIGNMENT)

book: .venv/.course ## build the book: book/_build/html/index.html
	@$(BIN)/python book/_tools/build_book.py

book-zip: .venv/.course build/campaign.json ## make one file of the book to hand out
	@$(BIN)/python book/_tools/build_book.py --zip

book-pdf: for-tests .venv/.dev browser ## make the PDF of the book to print
	@$(BIN)/python book/_tools/build_book.py --pdf

film: for-tests .venv/.dev browser ## make the first page's film and the live arm's stills from the built book
	@$(BIN)/python book/_tools/make_stills.py
	@$(BIN)/python book/_tools/make_film.py

vendor: .venv/.dev ## make the book's browser files again (node 20)
	@sh .ci/need.sh node:nodejs npm:npm
	@PYTHON="$(CURDIR)/$(BIN)/python" sh book/_tools/vendor.sh

campaign: .venv/.course ## run the compared controllers on every task: build/campaign.json
	@$(BIN)/python -m solutions.study

campaign-engines: .venv/.course ## run the campaign on every engine, and say where the engines differ
	@$(BIN)/python -m solutions.study.both_engines

record: .venv/.course ## make all recorded data again, and say which verdicts changed
	@$(BIN)/python -m solutions.study.record

build/campaign.json: # the book to hand out contains the films of the campaign
	@$(BIN)/python -m solutions.study

count: ## count the lines of code, storey by storey, beside their ceilings
	@python3 tests/test_size.py

bench: for-tests .venv/.dev browser ## measure speeds as ratios: build/bench.json
	@$(BIN)/python -m tests.bench

tag-bench: .venv/.course ## measure the precision of the tag sensor; SEED=n
	@$(BIN)/python -m tests.bench.tags --seed $(SEED)

report-card: .venv/.course ## test that the checks reject wrong answers and accept right ones
	@$(BIN)/labkit report-card

doctor: .venv/.course ## say how well this machine can isolate submissions
	@$(BIN)/labkit doctor

lint: .venv/.dev ## check style, spelling and who imports whom, and nothing else
	@$(BIN)/ruff check --quiet . && $(BIN)/ruff format --quiet --check . || { $(BIN)/ruff format --diff . ; exit 1; }
	@said=$$($(BIN)/lint-imports --no-logo --no-cache) || { echo "$$said"; exit 1; }
	@$(BIN)/codespell *.md book labkit solutions tests .ci

types: .venv/.dev ## check the types, and nothing else
	@$(BIN)/mypy --no-error-summary

format: .venv/.dev ## correct the style of the code
	@$(BIN)/ruff check --fix .; fault=$$?; $(BIN)/ruff format . && exit $$fault

clean: ## delete generated files; students' work, marks and hidden cases are kept
	rm -rf .venv .venv-313 dist book/_build book/generated build/[!c]* build/campaign*

# Environments for a student, an instructor and a developer; each adds packages to the one before.

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
	@"$$(sh .ci/find_python.sh)" -m venv .venv && touch $@

.venv/.student: .venv/.made pyproject.toml constraints.txt
	@echo "installing what a student needs"
	@$(INSTALL) -e . && touch $@

.venv/.course: .venv/.student
	@echo "installing what an instructor needs"
	@$(INSTALL) -e '.[instructor,book]' && touch $@

.venv/.dev: .venv/.course
	@echo "installing what a developer needs"
	@$(INSTALL) -e '.[dev]' && touch $@

.venv-313/.made: .venv/.dev pyproject.toml constraints.txt
	@echo "making .venv-313 with Python 3.13"
	@python=$$(PATH="$$PATH:$(CURDIR)/$(BIN)" sh .ci/find_python.sh 3.13) && "$$python" -m venv --clear .venv-313
	@$(SECOND)/pip install --quiet --disable-pip-version-check --constraint constraints.txt -e '.[test]' && touch $@
