# relief-tools: one Makefile, no recursion, nothing written outside build/.
#
#   make [MODE=release|debug|asan] [all check demo figures bench golden fuzz
#         install uninstall format clean check-headers check-symbols
#         check-style]
#
# CC, CXX, CFLAGS, CXXFLAGS, LDFLAGS add to what is set here and never replace
# a flag that the code needs. WERROR=1 makes warnings errors. CHECK='cli/pack
# unit/t_ao' runs just those tests; FUZZ_SECONDS=60 is each fuzz target's time.

MODE ?= release
B := build/$(MODE)
VERSION := 0.1.0
PREFIX ?= /usr/local
DESTDIR ?=
FUZZ_SECONDS ?= 60
.DEFAULT_GOAL := all
# what is made is named; V=1 shows the commands
Q := $(if $(V),,@)
SAY = @mkdir -p $(@D)$(if $(V),,; echo '  $@')

# -- flags ---------------------------------------------------------------
PKGS := OpenImageIO OpenColorIO OpenEXR fftw3 jansson assimp
PKG_CFLAGS := $(shell pkg-config --cflags $(PKGS) 2>/dev/null | sed 's/-I/-isystem /g')
PKG_LIBS := $(shell pkg-config --libs $(PKGS) 2>/dev/null)
ifeq ($(PKG_LIBS),)
$(warning pkg-config does not find all of: $(PKGS); try scripts/bootstrap)
endif

OPT_release := -O3 -g
OPT_debug := -O0 -g3
OPT_asan := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all \
	-fno-omit-frame-pointer
ifeq ($(OPT_$(MODE)),)
$(error MODE is $(MODE), expected release, debug or asan)
endif

WARN := -Wall -Wextra -Wshadow -Wpointer-arith -Wcast-qual -Wwrite-strings \
	-Wundef -Wvla
WARN_C := -Wstrict-prototypes -Wmissing-prototypes
WERROR_1 := -Werror
# the same bytes everywhere: no fused multiply-add, no fast-math
BASE := $(OPT_$(MODE)) $(WARN) $(WERROR_$(WERROR)) -fPIC -fopenmp \
	-ffp-contract=off -fvisibility=hidden -D_GNU_SOURCE \
	-DRELIEF_VERSION='"$(VERSION)"' -Ilibbake
BASE_CFLAGS := -std=c11 $(BASE) $(WARN_C)
BASE_CXXFLAGS := -std=c++17 $(BASE) $(PKG_CFLAGS)
BASE_LDFLAGS := $(OPT_$(MODE)) -fopenmp
# a tool loads only the libraries that it uses; Apple's linker has no such flag
ifneq ($(shell uname -s),Darwin)
BASE_LDFLAGS += -Wl,--as-needed
endif
LIBS := $(PKG_LIBS) -lm

# -- objects -------------------------------------------------------------
# A kernel (libbake/*_kernel.c) is compiled once for each instruction set.
ifneq ($(filter x86_64 amd64,$(shell uname -m)),)
ISAS := baseline avx2 avx512
else
ISAS := baseline
endif
ISA_CFLAGS_avx2 := -mavx2
ISA_CFLAGS_avx512 := -mavx512f -mavx512vl -mavx512dq -mavx512bw \
	-mprefer-vector-width=512

KERNELS := $(wildcard libbake/*_kernel.c)
LIB_C := $(filter-out $(KERNELS),$(wildcard libbake/*.c))
LIB_CXX := $(wildcard libbake/*.cpp)
LIB_O := $(LIB_C:%=$(B)/%.o) $(LIB_CXX:%=$(B)/%.o) \
	$(foreach isa,$(ISAS),$(KERNELS:%=$(B)/%.$(isa).o))
TOOLS := $(patsubst cmd/%.c,$(B)/bin/%,$(wildcard cmd/rm-*.c))
FRAME_O := $(patsubst %,$(B)/%.o,$(filter-out cmd/rm-%.c,$(wildcard cmd/*.c)))
UNIT := $(patsubst tests/unit/%.c,$(B)/tests/%,$(wildcard tests/unit/t_*.c))
BENCH := $(patsubst tests/bench/%.c,$(B)/bench/%,$(wildcard tests/bench/*.c))

all: $(TOOLS) $(B)/libbake.a

# Header dependencies, under a name that holds however B is spelt.
DEPS = -MMD -MP -MT '$$(B)$(@:$(B)%=%)'

# Objects depend on the commands that made them, so that other flags, another
# compiler or a removed source never leave a mixture behind.
define STAMP
$(B)/$(1).stamp: FORCE
	@mkdir -p $$(@D)
	@printf '%s\n' '$$(subst ','\'',$(2))' >$$@.new
	@if cmp -s $$@.new $$@; then rm -f $$@.new; else mv $$@.new $$@; fi
endef
$(eval $(call STAMP,compile,$$(CC) $$(BASE_CFLAGS) $$(CFLAGS) / $$(CXX) \
	$$(BASE_CXXFLAGS) $$(CXXFLAGS) / $$(foreach i,$$(ISAS),$$(ISA_CFLAGS_$$(i)))))
$(eval $(call STAMP,link,$$(CXX) $$(BASE_LDFLAGS) $$(LDFLAGS) $$(LIBS)))
$(eval $(call STAMP,objects,$$(subst $$(B)/,,$$(LIB_O) $$(FRAME_O))))
FORCE:

# an archive, so that a tool links just what it uses of the frame
$(B)/frame.a: $(FRAME_O) $(B)/objects.stamp
	$(SAY)
	@rm -f $@
	$(Q)$(AR) rcs $@ $(FRAME_O)
$(B)/bin/%: $(B)/cmd/%.c.o $(B)/frame.a $(B)/libbake.a $(B)/link.stamp
	$(SAY)
	$(Q)$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $(filter-out %.stamp,$^) \
	    $(LIBS)
$(B)/libbake.a: $(LIB_O) $(B)/objects.stamp
	$(SAY)
	@rm -f $@
	$(Q)$(AR) rcs $@ $(LIB_O)
$(B)/%.c.o: %.c $(B)/compile.stamp
	$(SAY)
	$(Q)$(CC) $(BASE_CFLAGS) $(CFLAGS) $(DEPS) -c -o $@ $<
$(B)/%.cpp.o: %.cpp $(B)/compile.stamp
	$(SAY)
	$(Q)$(CXX) $(BASE_CXXFLAGS) $(CXXFLAGS) $(DEPS) -c -o $@ $<
# $(1) instruction set, $(2) folder, $(3) compiler, $(4) further flags
define ISA_RULE
$(2)/%_kernel.c.$(1).o: %_kernel.c $(B)/compile.stamp
	$$(SAY)
	$$(Q)$(3) $$(BASE_CFLAGS) $(4) $$(CFLAGS) $$(ISA_CFLAGS_$(1)) \
	    -DBAKE_KERNEL_ISA=$(1) $$(DEPS) -c -o $$@ $$<
endef
$(foreach isa,$(ISAS),$(eval $(call ISA_RULE,$(isa),$(B),$$(CC),)))

# -- tests ---------------------------------------------------------------
$(B)/tests/%: $(B)/tests/unit/%.c.o $(B)/libbake.a $(B)/link.stamp
	$(SAY)
	$(Q)$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $(filter-out %.stamp,$^) \
	    $(LIBS)
# private: link.stamp must not see these
$(B)/tests/t_nomem $(B)/tests/t_nomem_layers: private override LDFLAGS += \
	$(foreach f,_Znam _Znwm aligned_alloc asprintf calloc fdopen free \
	malloc realloc realpath strdup strndup tmpfile,-Wl,--wrap=$(f))
$(B)/bench/%: $(B)/tests/bench/%.c.o $(B)/libbake.a $(B)/link.stamp
	$(SAY)
	$(Q)$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $(filter-out %.stamp,$^) \
	    $(LIBS)

# Fuzz targets: the library once more, by clang with libFuzzer's coverage.
FUZZ_CC ?= clang
FUZZ_CXX ?= clang++
FUZZ_FLAGS := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all \
	-Wno-unknown-warning-option
FB := $(B)/fuzz
FUZZ := $(patsubst tests/fuzz/%.c,$(FB)/bin/%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_O := $(LIB_O:$(B)/%=$(FB)/%)
$(FB)/bin/%: $(FB)/tests/fuzz/%.c.o $(FUZZ_O) $(B)/link.stamp
	$(SAY)
	$(Q)$(FUZZ_CXX) $(FUZZ_FLAGS) -fsanitize=fuzzer -fopenmp $(LDFLAGS) -o $@ \
	    $(filter-out %.stamp,$^) $(LIBS)
$(FB)/%.c.o: %.c $(B)/compile.stamp
	$(SAY)
	$(Q)$(FUZZ_CC) $(BASE_CFLAGS) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link \
	    $(CFLAGS) $(DEPS) -c -o $@ $<
$(FB)/%.cpp.o: %.cpp $(B)/compile.stamp
	$(SAY)
	$(Q)$(FUZZ_CXX) $(BASE_CXXFLAGS) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link \
	    $(CXXFLAGS) $(DEPS) -c -o $@ $<
$(foreach isa,$(ISAS),$(eval $(call ISA_RULE,$(isa),$(FB),$$(FUZZ_CC),\
	$$(FUZZ_FLAGS) -fsanitize=fuzzer-no-link)))
# They are part of a release build's check where clang can build them; a
# build with sanitizers has these already.
ifneq ($(filter check,$(MAKECMDGOALS)),)
ifeq ($(MODE),release)
CAN_FUZZ := $(shell $(FUZZ_CC) -fopenmp -fsanitize=fuzzer,address,undefined \
	tests/fuzz/probe.c -o /dev/null 2>/dev/null && echo yes)
endif
endif

# What the scripts below need to know; they write into $(B) only.
SCRIPT_ENV := B='$(B)' MODE='$(MODE)' CC='$(CC)' CXX='$(CXX)' \
	FUZZ_SECONDS='$(FUZZ_SECONDS)' MAKE='$(MAKE)'
check-headers check-style: export CHECK_CFLAGS = $(BASE_CFLAGS)
check: export CHECK_CFLAGS = $(BASE_CFLAGS)

check: all $(UNIT) $(if $(CAN_FUZZ),$(FUZZ))
	@$(SCRIPT_ENV) scripts/check $(CHECK)
units: $(UNIT) $(BENCH)
check-headers: $(wildcard libbake/*.h)
	@$(SCRIPT_ENV) scripts/check-headers
check-symbols: $(B)/libbake.a
	@$(SCRIPT_ENV) scripts/check-symbols
check-style: all
	@$(SCRIPT_ENV) scripts/check-style
golden: all
	@$(SCRIPT_ENV) scripts/golden --remake
bench: all $(BENCH)
	@$(SCRIPT_ENV) scripts/bench
fuzz: $(FUZZ)
	@$(SCRIPT_ENV) scripts/fuzz
demo: all
	@$(SCRIPT_ENV) scripts/demo
figures: all
	@$(SCRIPT_ENV) scripts/figures
format:
	clang-format -i $(wildcard cmd/*.[ch] libbake/*.[ch] libbake/*.cpp \
	    tests/*/*.[ch] tests/*/*.cpp)
clean:
	rm -rf build

# -- installing ----------------------------------------------------------
MAN := $(wildcard man/*.[0-9])
HEADERS := $(filter-out %_priv.h,$(wildcard libbake/*.h))
DEST := $(DESTDIR)$(PREFIX)

$(B)/relief.pc: FORCE
	$(SAY)
	@printf '%s\n' 'prefix=$(PREFIX)' 'libdir=$${prefix}/lib' \
	    'includedir=$${prefix}/include' '' 'Name: relief' \
	    'Description: baking of relief textures' 'Version: $(VERSION)' \
	    'Requires: $(PKGS)' 'Cflags: -I$${includedir}/relief' \
	    'Libs: -L$${libdir} -lbake -fopenmp -lstdc++ -lm' >$@

install: all $(B)/relief.pc
	mkdir -p '$(DEST)/bin' '$(DEST)/lib/pkgconfig' '$(DEST)/include/relief' \
	    '$(DEST)/share/relief'
	install -m 755 $(TOOLS) '$(DEST)/bin'
	install -m 644 $(HEADERS) '$(DEST)/include/relief'
	install -m 644 $(B)/libbake.a '$(DEST)/lib'
	install -m 644 $(B)/relief.pc '$(DEST)/lib/pkgconfig'
	install -m 644 scripts/relief.mk '$(DEST)/share/relief'
	for m in $(MAN); do install -D -m 644 $$m \
	    '$(DEST)'/share/man/man$${m##*.}/$${m##*/} || exit; done
uninstall:
	rm -f $(foreach f,$(notdir $(TOOLS)),'$(DEST)/bin/$(f)') \
	    $(foreach f,$(notdir $(MAN)),'$(DEST)'/share/man/man*/$(f)) \
	    '$(DEST)/lib/libbake.a' '$(DEST)/lib/pkgconfig/relief.pc'
	rm -rf '$(DEST)/include/relief' '$(DEST)/share/relief'

.PHONY: all bench check check-headers check-style check-symbols clean demo figures \
	format fuzz golden install uninstall units FORCE
.DELETE_ON_ERROR:
.SECONDARY:
-include $(wildcard $(B)/*/*.d $(B)/tests/*/*.d $(FB)/*/*.d \
	$(FB)/tests/*/*.d)
