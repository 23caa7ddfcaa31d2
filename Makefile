# The few commands a person types; everything else is CMake. Variables:
#   PROFILE=standard|smoke|paper   size of the experiments
#   ONLY=fig7                      only experiments, of `make compare` too, or targets of `make fuzz`, whose names contain this
#   MINUTES=1                      of `make fuzz` for each reader
#   PRESET=release|asan|tsan       see CMakePresets.json
#   BUILD=FOLDER                   where to build
#   COUNT=3, SEED=1                how much `make check` disturbs each command, and when
#   PYTHON=/usr/bin/python3        of `make peers`: the one that has PyTorch and SciPy
#   RUNS=FOLDER, OUTPUT=build/report  of `make report`: the runs to draw it from, and where it goes then
#   BENCH_DATASET=, BENCH_FLAGS=   what `make bench` measures on, and flags of Google Benchmark
#   PACKAGES=test                  of `make packages` and `make configure`: the part of scripts/install-packages.sh
PROFILE ?= standard
ONLY ?=
MINUTES ?= 1
PRESET ?= release
BUILD ?= build/$(PRESET)
JOBS ?= $(shell nproc)
BENCH_DATASET ?= datasets/packed/star-standard
BENCH_FLAGS ?=
PACKAGES ?= test
PYTHON ?= /usr/bin/python3
RUNS ?=
OUTPUT ?= build/report
COUNT ?= 3
SEED ?= 1

.PHONY: build python test check chip odr clang fuzz faults sanitized experiments report article compare bench radiafit-bench peers smoke configure \
    packages format format-check archive clean
.NOTPARALLEL:

# How each command begins: $(call configure,PART,OPTIONS) installs a part of the list of packages, and configures, always, so
# that results name the revision that was built. CMake keeps the options, so that commands in turn compile nothing again.
configure = @scripts/install-packages.sh $(1) && cmake --preset $(PRESET) -B $(BUILD) $(2) --log-level=WARNING
compile = cmake --build $(BUILD) --parallel $(JOBS)
with_python = $(if $(filter release,$(PRESET)),-DRADIAFIT_PYTHON=ON)

# The program, radiafit-bench and the library: what `cmake --install` installs.
build:
	$(call configure,build)
	@$(compile) --target installed
	@echo "the program: $(BUILD)/bin/radiafit"

# The module for Python, which `make test` tests; docs/python.md.
python:
	$(call configure,python,$(with_python))
	@$(compile) --target radiafit_python
	@echo "the module: $(BUILD)/python; PYTHONPATH=$(BUILD)/python python3 finds it"

# What only the tests' runs need, such as a browser, is installed while the compilers are busy.
test:
	$(call configure,test-programs,-DBUILD_TESTING=ON $(with_python))
	@scripts/install-packages.sh test -- $(compile)
	@ctest --test-dir $(BUILD) --output-on-failure --no-tests=error --parallel $(JOBS)
	@scripts/slowest.py $(BUILD)
	@echo "all tests passed; log: $(BUILD)/Testing/Temporary/LastTest.log"

# What `make test` has no time for: clang, faults (kills, full disks, several writers, inputs that change), radiafit-bench
# as it is built for other machines, sanitizers; the texts' own checks first.
check:
	$(call configure,check,-DBUILD_TESTING=ON)
	@ctest --test-dir $(BUILD) --output-on-failure --label-regex text
	@python3 -B tests/check_headers.py $(BUILD)
	@python3 -B tests/capture_sweep_test.py $(BUILD)/bin/radiafit --all
	@$(MAKE) --no-print-directory chip
	@$(compile)
	@python3 -B tests/draw_reference.py $(BUILD)
	@$(MAKE) --no-print-directory odr
	@$(MAKE) --no-print-directory clang
	@$(MAKE) --no-print-directory faults
	@$(MAKE) --no-print-directory radiafit-bench
	@python3 -B tests/bench_alone_test.py build/bench/bin/radiafit-bench . "$$(command -v c++)"
	@$(MAKE) --no-print-directory sanitized PRESET=asan BUILD=build/asan
	@$(MAKE) --no-print-directory sanitized PRESET=tsan BUILD=build/tsan

# The OpenGL suite on llvmpipe under a graphics chip's name, the second OpenGL below Vulkan's validation layers, and a mesh from made photographs.
chip:
	$(call configure,check,-DBUILD_TESTING=ON)
	@$(compile) --target test_programs
	@ctest --test-dir $(BUILD) -C check --output-on-failure --no-tests=error --parallel $(JOBS) --tests-regex '^(chip|validated)_|^mesh_of_photographs$$'

# That no name is defined twice, differently, in what becomes one program: link-time optimization sees all of its sources.
odr:
	@scripts/install-packages.sh build
	@cmake --preset odr --log-level=WARNING
	@cmake --build build/odr --parallel $(JOBS) --target radiafit radiafit-bench report

# That clang warns of nothing, and clang-tidy finds nothing.
clang:
	@scripts/install-packages.sh clang
	@scripts/run-clang-tidy.sh $(JOBS)

# ONLY=TEXT: kinds of faults and commands whose line contains it.
faults:
	$(call configure,faults)
	@$(compile) --target radiafit table1_datasets fig7_convergence
	@python3 -B tests/faults/faults.py $(BUILD) --count $(COUNT) --seed $(SEED) --only '$(ONLY)'

# The test programs by a sanitizer's preset; its suppressions, and why, are in tests/lsan.supp and tests/tsan.supp.
sanitized:
	$(call configure,test-programs)
	@$(compile) --target test_programs
	@ctest --preset $(PRESET) --test-dir $(BUILD) --parallel $(JOBS) --label-exclude 'smoke|program|text'
	@scripts/slowest.py $(BUILD)

# Every reader on mutated files, MINUTES each. What was learnt stays in build/fuzz/fuzz for the next time.
fuzz:
	@scripts/install-packages.sh fuzz
	@cmake --preset fuzz --log-level=WARNING
	@cmake --build build/fuzz --parallel $(JOBS) --target fuzz_readers
	@tests/fuzz/run_fuzz.py build/fuzz/tests/fuzz/fuzz_readers build/fuzz/fuzz --minutes $(MINUTES) \
	    --only "$(ONLY)" --jobs $(JOBS)

experiments:
	$(call configure,experiments)
	@names=$$(scripts/run-experiments.sh --list $(ONLY)) && $(compile) --target $$names
	@scripts/run-experiments.sh $(BUILD) $(PROFILE) $(ONLY)

# Every claim, figure and table on one page, from the runs that there are, without running any again; docs/report.md.
report:
	$(call configure,experiments)
	@$(compile) --target claims report
	@for name in claims report; do $(BUILD)/experiments/$$name --profile $(PROFILE) \
	    $(if $(RUNS),--set 'results="$(RUNS)"' --output $(OUTPUT)) || exit; done

# Our article on what the paper's claims come to: its numbers and figures are drawn from results/reference; docs/experiments.md.
article:
	$(call configure,article)
	@$(compile) --target fig7_convergence fig8_time fig9_error solvers
	@python3 -B docs/article/fill.py --programs $(BUILD)/experiments
	@cd build/article && pandoc --defaults ../../docs/article/layout.yaml article.md -o article.pdf
	@echo "the article: build/article/article.pdf"

# What differs from the runs that came with the checkout; docs/compare.md.
compare:
	$(call configure,experiments)
	@$(compile) --target radiafit
	@$(BUILD)/bin/radiafit compare results/reference results --only '$(ONLY)'

# Kernels alone, by Google Benchmark; BENCH_FLAGS such as --benchmark_filter=line.
bench:
	$(call configure,bench)
	@$(compile) --target radiafit kernel_benches
	@[ -d $(BENCH_DATASET) ] || $(BUILD)/bin/radiafit generate star --scale standard -o $(BENCH_DATASET)
	@$(BUILD)/experiments/bench/bench_kernels $(BENCH_DATASET) $(BENCH_FLAGS)
	@$(BUILD)/experiments/bench/bench_texels $(BENCH_FLAGS)
	@$(BUILD)/experiments/bench/bench_texel_passes $(BENCH_FLAGS)

# One file that needs no other, to be copied to a machine with a graphics chip; docs/gpu.md.
radiafit-bench:
	@scripts/install-packages.sh radiafit-bench
	@cmake --preset bench --log-level=WARNING
	@cmake --build build/bench --parallel $(JOBS)
	@echo "the program: build/bench/bin/radiafit-bench"

# PyTorch and SciPy on the CPU against our own fits, on exported problems; docs/results.md, peers.
peers:
	$(call configure,peers)
	@$(compile) --target radiafit
	@$(PYTHON) -B experiments/peers/peers.py --radiafit $(BUILD)/bin/radiafit --profile $(PROFILE)

smoke:
	@$(MAKE) --no-print-directory experiments PROFILE=smoke

configure:
	$(call configure,$(PACKAGES))

packages:
	@scripts/install-packages.sh $(PACKAGES)

format:
	@scripts/install-packages.sh format
	@find src tests experiments \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 clang-format -i

format-check:
	@scripts/install-packages.sh format
	@tests/check_format

# HEAD with its reference results and checksums, for a deposit: the same bytes whoever makes it.
archive:
	@scripts/make-archive.sh

# Builds and runs that were broken off; finished results and figures stay.
clean:
	rm -rf build
	@find results paper_figs datasets \( -name '.radiafit-tmp-*' -o -name '.radiafit-old-*' \) -prune -exec rm -rf {} +
