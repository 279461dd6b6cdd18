# SPDX-License-Identifier: MIT
# The front door. `make` leaves the command at build/steradian; CMake does the work.
BUILD ?= build
PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
OUT ?= out
SECONDS ?= 60
# further options of CMake, such as -DSTERADIAN_WERROR=ON
CONFIGURE ?=

.PHONY: all render test test-asan test-tsan fuzz soak soak-rays same-bytes mutants validate bench scale wavelengths check figures format format-reference install clean packages

all: packages
	@cmake -S . -B $(BUILD) -DCMAKE_BUILD_TYPE=Release $(CONFIGURE) >$(BUILD).log 2>&1 || { cat $(BUILD).log; exit 1; }
	@cmake --build $(BUILD) --parallel $(JOBS)

packages:
	@scripts/install-packages

# The project's own Cornell box, and how much light falls on its floor.
render: all
	@mkdir -p $(OUT)
	$(BUILD)/steradian render scenes/cornell-box.pbrt -o $(OUT)/cornell-box.exr -o $(OUT)/cornell-box.png \
	  --irradiance 0.278,0,0.2796,0,1,0
	@echo "The picture: $(OUT)/cornell-box.png; with error bars and auxiliary channels: $(OUT)/cornell-box.exr"

test: all
	ctest --test-dir $(BUILD) --output-on-failure --parallel $(JOBS)

test-asan: packages
	cmake --preset asan $(CONFIGURE) >/dev/null
	cmake --build build-asan --parallel $(JOBS)
	ctest --test-dir build-asan --output-on-failure --parallel $(JOBS)

test-tsan: packages
	cmake --preset tsan $(CONFIGURE) >/dev/null
	cmake --build build-tsan --parallel $(JOBS)
	ctest --test-dir build-tsan --output-on-failure -L tsan

# each reader of foreign files, SECONDS long, with sanitizers; by libFuzzer where clang is there
fuzz: packages
	cmake -S . -B build-fuzz -DSTERADIAN_FUZZ=ON -DBUILD_TESTING=OFF -DCMAKE_BUILD_TYPE=Debug $(CONFIGURE) \
	  $$(command -v clang >/dev/null && echo -DCMAKE_C_COMPILER=clang) >/dev/null
	@cmake --build build-fuzz --parallel $(JOBS) --target fuzz_programs >build-fuzz.log 2>&1 || { cat build-fuzz.log; exit 1; }
	scripts/fuzz build-fuzz/fuzz $(SECONDS)

# what takes long to go wrong: renders killed, interrupted and starved of disk, and resumed (docs/guide/long-renders.md)
soak: all
	python3 tests/soak/resume.py $(BUILD)/steradian --fault $(BUILD)/tests/libsoak_fault.so

# each picture by threads x tiles x ranks, in parts, killed and gone on with: always one SHA-256 (docs/robustness.md); half an hour
same-bytes: all
	python3 tests/soak/same_bytes.py $(BUILD)/steradian $(BUILD)/steradian-mpi

# scenes whose answers are known, to a relative standard uncertainty of GOAL
GOAL ?= 0.0125%
validate: all
	$(BUILD)/steradian validate --goal $(GOAL) --markdown docs/validation.md

# wrong versions of the program, each of which a test must catch
mutants: packages
	python3 tests/mutants/mutants.py . build-mutants

# 10^9 rays from inside of closed meshes, 10^9 that leave surfaces and 10^9 that leave floors: an hour of one processor
soak-rays: all
	$(BUILD)/sr_soak

bench: all
	$(BUILD)/sr_bench

# how time and memory grow: docs/scale.md and its figure; builds for 4 and 16 wavelengths beside, then some minutes on a quiet machine
RUNS ?= 3
scale: all
	JOBS=$(JOBS) bench/scale $(BUILD) $(RUNS)

# paths of 4 and of 16 wavelengths give the pictures of those of 8, within their error bars
wavelengths: all
	JOBS=$(JOBS) tests/levels/wavelengths $(BUILD)

# format, house rules, fast tests: what one runs before a commit
check: all
	ctest --test-dir $(BUILD) --output-on-failure -L fast

# docs/figures and docs/theory, anew from the models' tables and sources
figures: all
	scripts/make-figures --command $(BUILD)/steradian

# docs/format.md, anew from the tables by which scenes are read
format-reference: all
	$(BUILD)/steradian formats --markdown >docs/format.md

# thrice: what one pass has wrapped the next may lay out again
format:
	for pass in 1 2 3; do git ls-files '*.c' '*.h' | xargs clang-format -i; done

install: all
	cmake --install $(BUILD) --prefix $(PREFIX)

clean:
	rm -rf $(BUILD) build-asan build-tsan build-debug build-levels build-fuzz build-mutants $(BUILD)-w4 $(BUILD)-w16 $(OUT) *.log
