/* The shortest decimals of a number that read back as the same number. */
/* SPDX-License-Identifier: MIT */
#ifndef BAKE_QUADRIC_TEXT_PRIV_H
#define BAKE_QUADRIC_TEXT_PRIV_H

#ifdef __cplusplus
extern "C" {
#endif

enum { BAKE_NUMBER_TEXT = 32 };

/* Write v, which is finite, to out, which has room for BAKE_NUMBER_TEXT;
 * returns where it ends. No terminating null, no locale; 1e+20, not 1e20. The
 * text is a number in JSON, too. */
char *bake_number_text(char *out, double v)
#ifdef __cplusplus
    noexcept
#endif
    ;

#ifdef __cplusplus
}
#endif

#endif
