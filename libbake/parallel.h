/* Threads and progress: what every long-running bake takes. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_PARALLEL_H
#define BAKE_PARALLEL_H

#include "err.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Called now and then with the done share of the work, 0 .. 1, never
 * decreasing, always on the thread that called the bake. report may be NULL.
 */
struct bake_progress {
	void (*report)(void *arg, double done);
	void *arg;
};

/*
 * The number of threads to use when nthreads were asked for: itself, or all
 * processors that this process may use when it is 0. Results never depend on
 * it. Reentrant.
 */
BAKE_API int bake_threads(int nthreads);

#ifdef __cplusplus
}
#endif

#endif
