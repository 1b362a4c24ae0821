/* Threads: how many a bake uses. */
/* SPDX-License-Identifier: MIT */
#include "parallel.h"

#include <omp.h>

int
bake_threads(int nthreads)
{
	return nthreads > 0 ? nthreads : omp_get_num_procs();
}
