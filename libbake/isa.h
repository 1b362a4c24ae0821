/* The instruction set that the kernels run on, chosen at run time. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ISA_H
#define BAKE_ISA_H

/*
 * Each libbake/NAME_kernel.c is compiled once per instruction set, its entry
 * points suffixed _baseline, _avx2 and _avx512 (x86-64) or _baseline alone.
 * All give the same bytes; they differ in speed only.
 */
enum bake_isa { BAKE_ISA_BASELINE, BAKE_ISA_AVX2, BAKE_ISA_AVX512 };

/*
 * The best set that this processor has. The environment variable BAKE_ISA =
 * baseline, avx2 or avx512 sets an upper limit, for tests and bug reports;
 * any other value is ignored. Reentrant, as far as getenv is.
 */
enum bake_isa bake_isa_pick(void);

/*
 * Name a kernel's entry point: BAKE_KERNEL(bake_x) is bake_x_avx2 in the file
 * that is compiled with -DBAKE_KERNEL_ISA=avx2.
 */
#define BAKE_KERNEL_PASTE2(name, isa) name##_##isa
#define BAKE_KERNEL_PASTE(name, isa) BAKE_KERNEL_PASTE2(name, isa)
#define BAKE_KERNEL(name) BAKE_KERNEL_PASTE(name, BAKE_KERNEL_ISA)

/* The three entry points of one kernel, as an array indexed by bake_isa. */
#if defined(__x86_64__)
#define BAKE_KERNEL_TABLE(name)                                                \
	{                                                                      \
		name##_baseline, name##_avx2, name##_avx512                    \
	}
#else
#define BAKE_KERNEL_TABLE(name)                                                \
	{                                                                      \
		name##_baseline, name##_baseline, name##_baseline              \
	}
#endif

#endif
