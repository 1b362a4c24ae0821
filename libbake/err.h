/* Error values: a status code and one whole message, carried upwards. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_ERR_H
#define BAKE_ERR_H

#ifdef __cplusplus
extern "C" {
#endif

#define BAKE_API __attribute__((visibility("default")))

enum bake_status {
	BAKE_OK = 0,
	BAKE_EINVAL, /* a parameter is out of its range */
	BAKE_EDATA,  /* the data cannot be used: corrupt, wrong shape */
	BAKE_ENOMEM, /* memory, or a size that does not fit in size_t */
	BAKE_EIO,    /* the system refused to read or write */
	BAKE_ELIMIT  /* larger than the limit that the caller set */
};

enum { BAKE_ERR_MSG = 1024 };

/*
 * The reason for a failure. msg is whole (it names the thing and the two
 * numbers that disagree), starts in lower case and has no full stop; it is
 * empty until something fails. Plain data: copy it freely, nothing to free.
 */
struct bake_err {
	enum bake_status code;
	char msg[BAKE_ERR_MSG];
};
#define BAKE_ERR_INIT                                                          \
	{                                                                      \
		BAKE_OK, ""                                                    \
	}

/*
 * Record a failure and return its code, so that one line fails:
 *     return bake_fail(err, BAKE_EDATA, "'%s' has no channel", path);
 * The first failure wins: a later one does not replace the message, but its
 * own code is returned. A message longer than BAKE_ERR_MSG is cut.
 *
 *   err   never NULL
 *   code  not BAKE_OK
 *
 * Thread safety: none for one err; each thread brings its own.
 */
BAKE_API enum bake_status bake_fail(struct bake_err *err, enum bake_status code,
    const char *fmt, ...) __attribute__((format(printf, 3, 4)));

#ifdef __cplusplus
}
#endif

#endif
