# `make help` says what there is. Rust is taken as there; Debian's packages are installed where they are missing.
#
#   CARGO_TARGET_DIR   where cargo builds (default: target)
#   FEATURES           flags for the program's build, e.g. FEATURES=--no-default-features (no SUNDIALS at all)
#                      or FEATURES='--features static' (SUNDIALS built from source; needs cmake)
#   MODEL, OUT         what `make run` runs, and where its results go
#   PYTHON             the interpreter for `make python` (default: python3)

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
MAKEFLAGS += --no-print-directory

FEATURES ?=
MODEL ?= models/paper_train.toml
OUT ?= out/$(basename $(notdir $(MODEL)))
CARGO ?= cargo
TARGET := $(or $(CARGO_TARGET_DIR),target)
DEBUG := $(TARGET)/debug/headland
RELEASE := $(TARGET)/release/headland

# Certificates for cargo's downloads; a C compiler, which also links, and the C library's headers; SUNDIALS' headers and
# libraries; libclang, which reads those headers.
PACKAGES := ca-certificates gcc libc6-dev libclang-dev libsundials-dev
ifneq (,$(findstring static,$(FEATURES)))
PACKAGES := ca-certificates gcc g++ libc6-dev libclang-dev cmake
endif
ifneq (,$(findstring --no-default-features,$(FEATURES)))
PACKAGES := ca-certificates gcc libc6-dev
endif

# What a target needs beside these.
MORE :=

# The environment in which the package for Python is built and tested.
PYTHON ?= python3
VENV := $(abspath $(TARGET))/python
BINDINGS := bindings/python

.PHONY: help run test bench python doc schema pictures clean deps rust build lint unit validate docs

help: ## this list
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | awk -F'\t' '{printf "make %-10s%s\n", $$1, $$2}'

run: build ## build the program, run the article's train, draw its plots
	@$(RELEASE) run $(MODEL) --plot --out $(OUT)
	@echo; echo "plots:"; ls -1 $(OUT)/*.png | sed 's/^/  /'

test: deps lint unit validate docs ## everything that must hold: format, lints, tests, reference problems, manuals

bench: deps ## benchmarks of the compiled functions and the integrators
	$(CARGO) bench --locked --workspace --bench '*'

# Debian's python3 comes without ensurepip, which makes an environment's pip.
python: MORE = $(shell $(PYTHON) -c "import ensurepip, venv" > /dev/null 2>&1 || echo python3-venv)
python: deps ## the package for Python: built, installed into an environment of its own, tested
	@[ -x $(VENV)/bin/pip ] || $(PYTHON) -m venv $(VENV)
	@$(VENV)/bin/pip install --quiet 'maturin>=1.9,<2' 'numpy>=1.22' 'pytest>=7' || { \
	    echo "make: pip could not install maturin, numpy and pytest; what it says is above" >&2; \
	    echo "no package index in reach? set PIP_INDEX_URL to a mirror, or PIP_FIND_LINKS to a folder of wheels" >&2; \
	    exit 1; }
	PYO3_PYTHON=$(VENV)/bin/python $(CARGO) clippy --locked --manifest-path $(BINDINGS)/Cargo.toml \
	    --target-dir $(abspath $(TARGET)) $(FEATURES) -- -D warnings
	rm -rf $(VENV)/wheels
	$(VENV)/bin/maturin build --locked --release --auditwheel skip --manifest-path $(BINDINGS)/Cargo.toml \
	    --target-dir $(abspath $(TARGET)) --interpreter $(VENV)/bin/python --out $(VENV)/wheels $(FEATURES)
	$(VENV)/bin/pip install --quiet --no-deps --no-index --force-reinstall $(VENV)/wheels/headland-*.whl
	$(VENV)/bin/pytest -q $(BINDINGS)
	@echo "import headland:  $(VENV)/bin/python"

doc: deps ## the libraries' documentation
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --workspace --no-deps --lib
	@echo "open $(TARGET)/doc/headland/index.html"

schema: build ## write docs/scene.schema.json anew
	$(RELEASE) schema > docs/scene.schema.json

pictures: build ## draw the pictures of the README anew
	@out=$$(mktemp -d); $(RELEASE) run models/paper_train.toml --plot --out $$out > /dev/null; \
	for p in path_of_a_1_seen_from_above power_on_the_drive; do \
	    cp $$out/$$p.png docs/img/train_$$p.png; done; rm -r $$out

clean: ## remove what was built and computed
	$(CARGO) clean
	rm -rf out

# What follows is called by the targets above.

build: deps
	$(CARGO) build --locked --release -p headland-cli $(FEATURES)

lint:
	$(CARGO) fmt --all --check
	$(CARGO) fmt --manifest-path $(BINDINGS)/Cargo.toml --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	$(CARGO) clippy --locked -p headland-cli --no-default-features -- -D warnings

# Programs and tests in one build, so that what they share is compiled once.
unit:
	$(CARGO) build --locked --workspace --bins --tests
	$(CARGO) test --locked --workspace --no-fail-fast

# With the program that `unit` built.
validate:
	$(DEBUG) validate

# The schema is what the program says, and the scenes shown in the manuals and kept in models/ are right.
docs:
	@$(DEBUG) schema | diff docs/scene.schema.json - || { echo "docs/scene.schema.json is old; run: make schema" >&2; exit 1; }
	@echo "docs/scene.schema.json is up to date"
	@dir=$$(mktemp -d); trap 'rm -r "$$dir"' EXIT; \
	awk -v dir="$$dir" '/^```toml/ { n += 1; next } /^```/ { file = ""; inside = 0; next } \
	    n > seen { seen = n; if (/^title/) file = sprintf("%s/%s_listing_%d.toml", dir, name(FILENAME), n) } \
	    file != "" { print > file } \
	    function name(path) { sub(/.*\//, "", path); sub(/\..*/, "", path); return path }' README.md docs/*.md; \
	for scene in models/*.toml "$$dir"/*.toml; do \
	    $(DEBUG) check $$scene > /dev/null || exit 1; echo "scene $$(basename $$scene) is right"; \
	done

rust:
	@command -v $(CARGO) > /dev/null || { \
	    echo "make: cargo is not on the PATH; headland needs Rust 1.95 or newer" >&2; exit 1; }

deps: rust
	@if ! command -v dpkg-query > /dev/null; then \
	    echo "note: this is not Debian; needed are a C compiler and $(filter-out gcc libc6-dev ca-certificates,$(PACKAGES)), by whatever name" >&2; \
	    exit 0; \
	fi; \
	missing=""; for p in $(PACKAGES) $(MORE); do \
	    dpkg-query -W -f '$${db:Status-Status}' $$p 2> /dev/null | grep -qx installed || missing="$$missing $$p"; \
	done; \
	[ -n "$$missing" ] || exit 0; \
	if [ "$$(id -u)" -eq 0 ]; then as_root=""; \
	elif command -v sudo > /dev/null; then as_root="sudo"; \
	else \
	    echo "missing packages:$$missing" >&2; \
	    echo "install them as root:  apt-get install$$missing" >&2; \
	    echo "or do without SUNDIALS (explicit integrator only):  make run FEATURES=--no-default-features" >&2; \
	    exit 1; \
	fi; \
	echo "installing:$$missing"; \
	apt="$$as_root env DEBIAN_FRONTEND=noninteractive apt-get"; \
	{ $$apt update -qq && $$apt install -y -qq --no-install-recommends $$missing; } < /dev/null || { \
	    echo "could not install:$$missing" >&2; exit 1; }
