# GNU make. `make run` simulates and draws a garment, `make woven` yarns that slide, `make knit` knits, `make yarn` one
# yarn against mechanics, `make hello` the smallest program, `make test` the tests, `make check` the scripts of
# tests/check. Only a C compiler and libm are needed for all but the last.

CFLAGS ?= -O2
STANDARD := -std=c99 -Wall -Wextra -pedantic -Wconversion -Wshadow
THREADS ?= -pthread -DTEST_THREADS
BUILD ?= build
SANITIZE ?= address,undefined
comma := ,
COMPILE = $(CC) $(STANDARD) $(CFLAGS) -I. -MMD -MP -c -o $@

# What examples, tests and benchmarks share: the library compiled once, file formats and drawing, the scenes.
SHARED := $(BUILD)/yarncloth.o \
    $(patsubst %.c,$(BUILD)/obj/%.o,$(sort $(wildcard examples/common/*.c tests/scenes/*.c)))
TEST_SOURCES ?= $(sort $(wildcard tests/*.c))
# Tests that reach behind the public functions are one unit with the library, which compiles no slower for them; but for
# those that change its constants.
INTERNAL := $(filter-out tests/test_direct.c,$(shell grep -l '"internals.h"' $(TEST_SOURCES)))
BENCHES := $(patsubst tests/bench/%.c,bench-%,$(sort $(wildcard tests/bench/*.c)))
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/%,$(sort $(wildcard examples/*.c)))

.PHONY: run woven knit yarn hello examples test check sanitize $(BENCHES) format clean FORCE

# make run SCENE=name ARGS="..." hands both to the program; without them it shows its default.
run: $(BUILD)/garment
	@mkdir -p out
	$(BUILD)/garment $(SCENE) $(ARGS)

# Cloth that lets its yarns go; make woven SCENE=snag draws one of the scenes.
woven: $(BUILD)/woven
	@mkdir -p out
	$(BUILD)/woven $(SCENE)

# Knits that curl, draw in or lie flat; make knit SCENE=curl draws one of the scenes.
knit: $(BUILD)/knit
	@mkdir -p out
	$(BUILD)/knit $(SCENE)

# One yarn against mechanics; make yarn SCENE=bead draws one of the scenes.
yarn: $(BUILD)/yarn
	@mkdir -p out
	$(BUILD)/yarn $(SCENE)

hello: $(BUILD)/hello
	$(BUILD)/hello

examples: $(EXAMPLES)

# make test TESTS="vec sparse -chol" runs the tests whose names contain one of the words, but none with a word behind a
# minus; LIBRARIES are linked with them.
test: $(BUILD)/tests
	$(BUILD)/tests $(TESTS)

# make check CHECKS="contents format" runs these alone.
check:
	@CC='$(CC)' sh tests/check/run.sh $(CHECKS)

# The tests under sanitizers, by default of addresses and undefined behaviour; make sanitize SANITIZE=thread for races.
sanitize:
	$(MAKE) test BUILD='$(BUILD)/sanitize/$(firstword $(subst $(comma), ,$(SANITIZE)))' \
	    CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=$(SANITIZE) -fno-sanitize-recover=all'

# make bench-NAME runs the benchmark of tests/bench/NAME.c, QUICK=1 a short form of it, ARGS="..." hands it words. What
# it prints is kept in out/bench-NAME.txt.
$(BENCHES):
	@mkdir -p out
	@$(if $(NEEDS),if ! { $(NEEDS); } >/dev/null 2>&1; then echo '$@ needs $(PACKAGES)'; exit; fi;) \
	    $(MAKE) --no-print-directory $(BUILD)/$@ && $(BUILD)/$@ $(if $(QUICK),--quick) $(ARGS)

# The rivals of bench-direct, and whether they are here.
RIVALS := -lcholmod -lopenblas
RIVAL_HEADERS := suitesparse/cholmod.h eigen3/Eigen/Core
bench-direct: PACKAGES := the Debian packages libsuitesparse-dev, libopenblas-dev and libeigen3-dev.
bench-direct: NEEDS = echo 'int main() {}' | \
    $(CXX) -x c++ - $(addprefix -include ,$(RIVAL_HEADERS)) -fsyntax-only && \
    echo 'int main() {}' | $(CXX) -x c++ - $(RIVALS) -o /dev/null

format:
	clang-format -i yarncloth.h $(wildcard examples/*.[ch] examples/*/*.[ch] tests/*.[ch] tests/*/*.[ch] \
	    tests/*/*/*.[ch] tests/*/*/*.cpp)

clean:
	rm -rf build out

# ---- files -----------------------------------------------------------------------------------------------------------

# The library's own unit is these two lines.
$(BUILD)/yarncloth.c:
	@mkdir -p $(@D)
	@printf '%s\n' '#define YARNCLOTH_IMPLEMENTATION' '#include "yarncloth.h"' > $@

$(BUILD)/yarncloth.o: $(BUILD)/yarncloth.c yarncloth.h
	$(COMPILE) $<

# The table of tests, from the lines that begin with TEST(name): nobody has to enter a test anywhere.
$(BUILD)/tests.inc: FORCE
	@mkdir -p $(@D)
	@sed -n 's/^TEST(\([A-Za-z0-9_]*\)).*/ENTRY(\1)/p' $(TEST_SOURCES) > $@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

$(BUILD)/internals.c: FORCE
	@mkdir -p $(@D)
	@printf '#include "%s"\n' tests/internals.h $(INTERNAL) > $@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

$(BUILD)/internals.o: $(BUILD)/internals.c
	$(COMPILE) -DYC_API=extern -Itests $(THREADS) $<

$(BUILD)/obj/tests/main.o: CPPFLAGS := -I$(BUILD)
$(BUILD)/obj/tests/main.o: $(BUILD)/tests.inc
$(BUILD)/obj/tests/%.o: THREAD_FLAGS := $(THREADS)

$(BUILD)/obj/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) $(CPPFLAGS) $(THREAD_FLAGS) $<

# The longest unit first.
$(BUILD)/tests: $(BUILD)/internals.o $(patsubst %.c,$(BUILD)/obj/%.o,$(filter-out $(INTERNAL),$(TEST_SOURCES))) \
    $(filter-out $(BUILD)/yarncloth.o,$(SHARED))
	$(CC) $(CFLAGS) $(THREADS) -o $@ $^ $(LIBRARIES) -lm

# hello.c brings its own implementation, as a newcomer's first program does; the other examples share one.
$(BUILD)/hello: $(BUILD)/obj/examples/hello.o
	$(CC) $(CFLAGS) -o $@ $^ -lm

$(filter-out $(BUILD)/hello,$(EXAMPLES)): $(BUILD)/%: $(BUILD)/obj/examples/%.o $(SHARED)
	$(CC) $(CFLAGS) -o $@ $^ -lm

$(BENCHES:%=$(BUILD)/%): $(BUILD)/bench-%: $(BUILD)/obj/tests/bench/%.o $(SHARED)
	$(CC) $(CFLAGS) -o $@ $(filter %.o,$^) -lm

# OpenBLAS stands before CHOLMOD's own choice of a BLAS; gcc's AVX-512 headers warn of themselves.
$(BUILD)/bench-direct: $(BUILD)/obj/tests/bench/direct/matrices.o $(BUILD)/bench-direct-rivals

$(BUILD)/bench-direct-rivals: tests/bench/direct/rivals.cpp
	@mkdir -p $(@D)
	$(CXX) -std=c++14 -O2 -march=native -DNDEBUG -Wall -Wextra -Wshadow -Wno-maybe-uninitialized -MMD -MP \
	    -o $@ $< -rdynamic -Wl,--no-as-needed $(RIVALS)

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
