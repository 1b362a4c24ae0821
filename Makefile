# relief-tools: one Makefile, no recursion, nothing written outside build/.
#
#   make [MODE=release|debug|asan] [all check demo figures bench golden fuzz
#         install uninstall dist deb deb-check format clean check-headers
#         check-symbols check-style]
#
# CC, CXX, CFLAGS, CXXFLAGS, LDFLAGS add to what is set here and never replace
# a flag that the code needs. WERROR=1 makes warnings errors. CHECK='cli/pack
# unit/t_ao' runs just those tests; make fuzz SECONDS=60 is each fuzz target's
# time, JOBS targets being run at once.

MODE ?= release
B := build/$(MODE)
VERSION := 0.1.0
PREFIX ?= /usr/local
DESTDIR ?=
FUZZ_SECONDS ?= $(or $(SECONDS),60)
.DEFAULT_GOAL := all
# what is made is named; V=1 shows the commands
Q := $(if $(V),,@)
SAY = @mkdir -p $(@D)$(if $(V),,; echo '  $@')

# -- flags ---------------------------------------------------------------
PKGS := OpenImageIO OpenColorIO OpenEXR fftw3 jansson assimp libxxhash
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
# whole tools, to be called: their main has their name
FUZZ_CMD_O := $(patsubst %,$(FB)/%.o,$(wildcard cmd/*.c))
$(FB)/cmd/rm-%.c.o: private override CFLAGS += -Wno-missing-prototypes \
	-Dmain=$(subst -,_,$(*F))_main
$(FB)/bin/fuzz_args $(FB)/bin/fuzz_tool_file: $(FUZZ_CMD_O)
$(FB)/bin/fuzz_args $(FB)/bin/fuzz_tool_file: private override LDFLAGS += \
	$(foreach f,bake_alloc bake_image_alloc bake_zalloc \
	cmd_signals_start fork,-Wl,--wrap=$(f))
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
SCRIPT_ENV := B='$(B)' MODE='$(MODE)' VERSION='$(VERSION)' CC='$(CC)' CXX='$(CXX)' \
	FUZZ_SECONDS='$(FUZZ_SECONDS)' JOBS='$(JOBS)' MAKE='$(MAKE)'
check-headers check-style: export CHECK_CFLAGS = $(BASE_CFLAGS)
check: export CHECK_CFLAGS = $(BASE_CFLAGS)

# preloaded; no flag of ours that changes what malloc is
$(B)/tests/fault_shim.so: tests/fault/shim.c $(B)/compile.stamp
	$(SAY)
	$(Q)$(CC) -std=c11 -O1 -g -D_GNU_SOURCE $(WARN) $(WARN_C) \
	    $(WERROR_$(WERROR)) -fPIC -shared -fvisibility=hidden -o $@ $< -ldl
# for a kernel and a processor that it is written for
ifneq ($(and $(filter Linux,$(shell uname -s)),$(filter x86_64 aarch64,$(shell \
	uname -m)),$(filter release debug,$(MODE))),)
SHIM := $(B)/tests/fault_shim.so
endif
check: all $(UNIT) $(SHIM) $(if $(CAN_FUZZ),$(FUZZ))
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
fuzz: $(FUZZ) $(TOOLS)
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
# LIBDIR and ZSHDIR are for distributions that have their own ideas of them. All
# that is installed finds the rest by where it lies itself: a tree that was
# installed can be moved.
LIBDIR ?= $(PREFIX)/lib
ZSHDIR ?= $(PREFIX)/share/zsh/site-functions
MAN := $(wildcard man/*.[0-9])
HEADERS := $(filter-out %_priv.h,$(wildcard libbake/*.h))
EXAMPLE := $(wildcard testdata/project/*.* testdata/project/Makefile)
EXAMPLE_MAPS := $(wildcard testdata/*.png testdata/*.obj)
BASH_COMPLETIONS := $(TOOLS:$(B)/bin/%=$(B)/completions/bash/%)
ZSH_COMPLETIONS := $(TOOLS:$(B)/bin/%=$(B)/completions/zsh/_%)
ifeq ($(LIBDIR),$(PREFIX)/lib)
PC_PREFIX := $${pcfiledir}/../..
else
PC_PREFIX := $(PREFIX)
endif

$(B)/completions/bash/% $(B)/completions/zsh/_%: $(B)/bin/% \
		scripts/make-completions
	@mkdir -p $(B)/completions/bash $(B)/completions/zsh
	$(if $(V),,@echo '  $(B)/completions/bash/$*')
	$(Q)ASAN_OPTIONS=detect_leaks=0 scripts/make-completions $< \
	    $(B)/completions/bash/$* $(B)/completions/zsh/_$*
all: $(BASH_COMPLETIONS) $(ZSH_COMPLETIONS)

$(B)/relief.pc: FORCE
	$(SAY)
	@printf '%s\n' 'prefix=$(PC_PREFIX)' \
	    'libdir=$(LIBDIR:$(PREFIX)/%=$${prefix}/%)' \
	    'includedir=$${prefix}/include' \
	    'mk=$${prefix}/share/relief/relief.mk' '' 'Name: relief' \
	    'Description: baking of relief textures' 'Version: $(VERSION)' \
	    'Requires: $(PKGS)' 'Cflags: -I$${includedir}/relief' \
	    'Libs: -L$${libdir} -lbake -fopenmp -lstdc++ -lm' >$@

# What is installed, for $(1), which is put or take: mode, files, folder.
define INSTALLED
	$(call $(1),755,$(TOOLS),$(PREFIX)/bin)
	$(call $(1),644,$(HEADERS),$(PREFIX)/include/relief)
	$(call $(1),644,$(B)/libbake.a,$(LIBDIR))
	$(call $(1),644,$(B)/relief.pc,$(LIBDIR)/pkgconfig)
	$(call $(1),644,scripts/relief.mk,$(PREFIX)/share/relief)
	$(if $(EXAMPLE),$(call $(1),644,$(EXAMPLE),$(PREFIX)/share/relief/example/project))
	$(if $(EXAMPLE),$(call $(1),644,$(EXAMPLE_MAPS),$(PREFIX)/share/relief/example))
	$(call $(1),644,$(BASH_COMPLETIONS),$(PREFIX)/share/bash-completion/completions)
	$(call $(1),644,$(ZSH_COMPLETIONS),$(ZSHDIR))
	$(call $(1),644,$(filter %.1,$(MAN)),$(PREFIX)/share/man/man1)
	$(call $(1),644,$(filter %.3,$(MAN)),$(PREFIX)/share/man/man3)
	$(call $(1),644,$(filter %.5,$(MAN)),$(PREFIX)/share/man/man5)
	$(call $(1),644,$(filter %.7,$(MAN)),$(PREFIX)/share/man/man7)
endef
put = mkdir -p '$(DESTDIR)$(3)' && install -m $(1) $(2) '$(DESTDIR)$(3)'
take = rm -f $(foreach f,$(notdir $(2)),'$(DESTDIR)$(3)/$(f)')

install: all $(B)/relief.pc
	$(call INSTALLED,put)
uninstall:
	$(call INSTALLED,take)
	@for d in include/relief share/relief/example/project share/relief/example \
	    share/relief; do \
	    rmdir '$(DESTDIR)$(PREFIX)'/$$d 2>/dev/null || :; done

# The release as an archive, the same bytes for the same commit; Debian
# packages of it; these packages in a Debian of their own.
dist:
	@$(SCRIPT_ENV) scripts/dist
deb: dist
	@$(SCRIPT_ENV) scripts/deb
deb-check: deb
	@$(SCRIPT_ENV) scripts/deb-check

.PHONY: all bench check check-headers check-style check-symbols clean deb \
	deb-check demo dist figures format fuzz golden install uninstall units FORCE
.DELETE_ON_ERROR:
.SECONDARY:
-include $(wildcard $(B)/*/*.d $(B)/tests/*/*.d $(FB)/*/*.d \
	$(FB)/tests/*/*.d)
