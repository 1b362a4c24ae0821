/* The channel between a batch and its workers. */
/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

#include "cmd_batch_priv.h"

static bool
send_whole(int fd, const void *bytes, size_t n)
{
	const char *p = bytes;

	while (n > 0) {
		ssize_t k = send(fd, p, n, MSG_NOSIGNAL);

		if (k < 0 && errno == EINTR)
			continue;
		if (k <= 0)
			return false;
		p += k;
		n -= (size_t)k;
	}
	return true;
}

static bool
receive_whole(int fd, void *bytes, size_t n)
{
	char *p = bytes;

	while (n > 0) {
		ssize_t k = read(fd, p, n);

		if (k < 0 && errno == EINTR)
			continue;
		if (k <= 0)
			return false;
		p += k;
		n -= (size_t)k;
	}
	return true;
}

bool
message_send(int fd, const struct message *m, const char *text)
{
	return send_whole(fd, m, sizeof *m) &&
	       send_whole(fd, text, (size_t)m->ntext);
}

bool
message_receive(int fd, struct message *m, char text[MESSAGE_TEXT])
{
	if (!receive_whole(fd, m, sizeof *m) || m->ntext < 0 ||
	    m->ntext >= MESSAGE_TEXT ||
	    !receive_whole(fd, text, (size_t)m->ntext))
		return false;
	text[m->ntext] = '\0';
	return true;
}
