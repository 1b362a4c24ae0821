# relief-tools: one Makefile, no recursion, nothing written outside build/.
#
#   make [MODE=release|debug|asan] [all check demo bench golden fuzz
#         install uninstall format clean check-headers check-symbols]
#
# CC, CXX, CFLAGS, CXXFLAGS, LDFLAGS add to what is set here and never replace
# a flag that the code needs. WERROR=1 makes warnings errors.

MODE ?= release
B := build/$(MODE)
VERSION := 0.1.0
PREFIX ?= /usr/local
DESTDIR ?=
.DEFAULT_GOAL := all

# -- flags ---------------------------------------------------------------
PKGS := OpenImageIO OpenEXR fftw3 jansson
PKG_CFLAGS := $(shell pkg-config --cflags $(PKGS) 2>/dev/null | sed 's/-I/-isystem /g')
PKG_LIBS := $(shell pkg-config --libs $(PKGS) 2>/dev/null)

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
BASE_LDFLAGS := $(OPT_$(MODE)) -fopenmp -Wl,--as-needed
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

$(B)/bin/%: $(B)/cmd/%.c.o $(FRAME_O) $(B)/libbake.a
	@mkdir -p $(@D)
	$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)
$(B)/libbake.a: $(LIB_O)
	@rm -f $@
	$(AR) rcs $@ $^
$(B)/%.c.o: %.c
	@mkdir -p $(@D)
	$(CC) $(BASE_CFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<
$(B)/%.cpp.o: %.cpp
	@mkdir -p $(@D)
	$(CXX) $(BASE_CXXFLAGS) $(CXXFLAGS) -MMD -MP -c -o $@ $<
define ISA_RULE
$(B)/%_kernel.c.$(1).o: %_kernel.c
	@mkdir -p $$(@D)
	$$(CC) $$(BASE_CFLAGS) $$(CFLAGS) $$(ISA_CFLAGS_$(1)) \
	    -DBAKE_KERNEL_ISA=$(1) -MMD -MP -c -o $$@ $$<
endef
$(foreach isa,$(ISAS),$(eval $(call ISA_RULE,$(isa))))

# -- tests ---------------------------------------------------------------
$(B)/tests/%: $(B)/tests/unit/%.c.o $(B)/libbake.a
	@mkdir -p $(@D)
	$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)
$(B)/bench/%: $(B)/tests/bench/%.c.o $(B)/libbake.a
	@mkdir -p $(@D)
	$(CXX) $(BASE_LDFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

.PHONY: all
.DELETE_ON_ERROR:
.SECONDARY:
-include $(wildcard $(B)/*/*.d $(B)/tests/*/*.d)
