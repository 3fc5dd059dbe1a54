# GNU make. `make run` simulates and draws a garment, `make hello` the smallest program, `make test` the tests,
# `make check` the scripts of tests/check. Only a C compiler and libm are needed for the first three.

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
BENCH_SOURCES := $(sort $(wildcard tests/bench*.c))
TEST_SOURCES := $(filter-out $(BENCH_SOURCES),$(sort $(wildcard tests/*.c)))
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/%,$(sort $(wildcard examples/*.c)))

.PHONY: run hello examples test check sanitize format clean FORCE

# make run SCENE=name ARGS="..." hands both to the program; without them it shows its default.
run: $(BUILD)/garment
	@mkdir -p out
	$(BUILD)/garment $(SCENE) $(ARGS)

hello: $(BUILD)/hello
	$(BUILD)/hello

examples: $(EXAMPLES)

# make test TESTS="vec sparse" runs the tests whose names contain one of these words.
test: $(BUILD)/tests
	$(BUILD)/tests $(TESTS)

# make check CHECKS="contents format" runs these alone.
check:
	@CC='$(CC)' sh tests/check/run.sh $(CHECKS)

# The tests under sanitizers, by default of addresses and undefined behaviour; make sanitize SANITIZE=thread for races.
sanitize:
	$(MAKE) test BUILD='$(BUILD)/sanitize/$(firstword $(subst $(comma), ,$(SANITIZE)))' \
	    CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=$(SANITIZE) -fno-sanitize-recover=all'

ifneq ($(BENCH_SOURCES),)
.PHONY: bench
bench: $(BUILD)/bench
	@mkdir -p out
	$(BUILD)/bench $(ARGS)

$(BUILD)/bench: $(BENCH_SOURCES:%.c=$(BUILD)/obj/%.o) $(SHARED)
	$(CC) $(CFLAGS) -o $@ $^ -lm
endif

format:
	clang-format -i yarncloth.h $(wildcard examples/*.[ch] examples/*/*.[ch] tests/*.[ch] tests/*/*.[ch])

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

$(BUILD)/obj/tests/main.o: CPPFLAGS := -I$(BUILD)
$(BUILD)/obj/tests/main.o: $(BUILD)/tests.inc
$(BUILD)/obj/tests/%.o: THREAD_FLAGS := $(THREADS)

$(BUILD)/obj/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) $(CPPFLAGS) $(THREAD_FLAGS) $<

$(BUILD)/tests: $(TEST_SOURCES:%.c=$(BUILD)/obj/%.o) $(SHARED)
	$(CC) $(CFLAGS) $(THREADS) -o $@ $^ -lm

# hello.c brings its own implementation, as a newcomer's first program does; the other examples share one.
$(BUILD)/hello: $(BUILD)/obj/examples/hello.o
	$(CC) $(CFLAGS) -o $@ $^ -lm

$(filter-out $(BUILD)/hello,$(EXAMPLES)): $(BUILD)/%: $(BUILD)/obj/examples/%.o $(SHARED)
	$(CC) $(CFLAGS) -o $@ $^ -lm

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
