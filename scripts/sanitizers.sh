# Sourced by what runs the sanitizer builds, with $top the project's folder.
# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
#
# The image libraries leak on some broken files: tests/lsan.supp names them. A
# finding ends a program with a status that no tool has, and is written to a
# file: the tools keep other people's text off standard error.
sanitizer_log=${TMPDIR:-/tmp}/relief-sanitizer
LSAN_OPTIONS=suppressions=$top/tests/lsan.supp:print_suppressions=0
ASAN_OPTIONS=allocator_may_return_null=1:fast_unwind_on_malloc=0
ASAN_OPTIONS=$ASAN_OPTIONS:exitcode=99:log_path=$sanitizer_log
UBSAN_OPTIONS=print_stacktrace=1:exitcode=99:log_path=$sanitizer_log
export ASAN_OPTIONS LSAN_OPTIONS UBSAN_OPTIONS
