/* The unit tests' frame: CHECK macros and a runner that counts. */
/* SPDX-License-Identifier: MIT */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_nfailed_here;

#define CHECK(cond)                                                            \
	do {                                                                   \
		if (!(cond)) {                                                 \
			printf("%s:%d: CHECK(%s) failed\n", __FILE__,          \
			    __LINE__, #cond);                                  \
			check_nfailed_here++;                                  \
		}                                                              \
	} while (0)

/* |got - want| <= tol; NaN fails */
#define CHECK_NEAR(got, want, tol)                                             \
	do {                                                                   \
		double check_g = (got), check_w = (want), check_t = (tol);     \
		if (!(fabs(check_g - check_w) <= check_t)) {                   \
			printf("%s:%d: %s = %.9g, expected %.9g +- %g\n",      \
			    __FILE__, __LINE__, #got, check_g, check_w,        \
			    check_t);                                          \
			check_nfailed_here++;                                  \
		}                                                              \
	} while (0)

#define CHECK_OK(status, err)                                                  \
	do {                                                                   \
		int check_s = (status);                                        \
		if (check_s != 0) {                                            \
			printf("%s:%d: %s = %d: %s\n", __FILE__, __LINE__,     \
			    #status, check_s, (err).msg);                      \
			check_nfailed_here++;                                  \
		}                                                              \
	} while (0)

struct check_case {
	const char *name;
	void (*run)(void);
};
#define CASE(f)                                                                \
	{                                                                      \
#f, f                                                          \
	}

/* Runs all cases (or the one named in argv[1]); prints 'NAME: N passed,
 * N failed' and returns the exit status. */
static inline int
check_main(int argc, char **argv, const struct check_case *cases, size_t n)
{
	const char *slash = strrchr(argv[0], '/');
	int npassed = 0, nfailed = 0;

	for (size_t i = 0; i < n; i++) {
		if (argc > 1 && strcmp(argv[1], cases[i].name) != 0)
			continue;
		check_nfailed_here = 0;
		cases[i].run();
		if (check_nfailed_here == 0) {
			npassed++;
		} else {
			nfailed++;
			printf("FAIL %s\n", cases[i].name);
		}
	}
	printf("%s: %d passed, %d failed\n", slash ? slash + 1 : argv[0],
	    npassed, nfailed);
	return nfailed != 0;
}

#endif
