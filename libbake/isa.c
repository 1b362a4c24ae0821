/* The instruction set that the kernels run on, chosen at run time. */
/* SPDX-License-Identifier: MIT */
#include "isa.h"

#include <stdlib.h>
#include <string.h>

static enum bake_isa
best_isa(void)
{
#if defined(__x86_64__)
	__builtin_cpu_init();
	if (__builtin_cpu_supports("avx512f") &&
	    __builtin_cpu_supports("avx512vl") &&
	    __builtin_cpu_supports("avx512dq") &&
	    __builtin_cpu_supports("avx512bw"))
		return BAKE_ISA_AVX512;
	if (__builtin_cpu_supports("avx2"))
		return BAKE_ISA_AVX2;
#endif
	return BAKE_ISA_BASELINE;
}

enum bake_isa
bake_isa_pick(void)
{
	static const char *const names[] = { "baseline", "avx2", "avx512" };
	enum bake_isa best = best_isa();
	const char *limit = getenv("BAKE_ISA");

	if (limit == NULL)
		return best;
	for (int i = 0; i < (int)best; i++)
		if (strcmp(limit, names[i]) == 0)
			return (enum bake_isa)i;
	return best;
}
