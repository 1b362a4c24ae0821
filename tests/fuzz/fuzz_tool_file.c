/* Fuzz target: any bytes as a file that a tool is given. */
/* SPDX-License-Identifier: MIT */
#include "fuzz_tools.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);

#define SMALL "--max-pixels", "4096", "-j", "1", "--no-isolate"
#define RENDER "rm-render", SMALL, "--size", "8x6", "-o", "out.png"

/* Command lines, chosen by the first byte from 'A' on; F stands for the file,
 * an extension after it is kept. A file of plain height is "h.png". */
static const char *const commands[][24] = {
	{ "rm-info", SMALL, "F" },
	{ "rm-info", SMALL, "--json", "F" },
	{ "rm-info", SMALL, "--check", "-s", "0.1", "F" },
	{ "rm-info", SMALL, "--compare", "F", "F" },
	{ "rm-info", SMALL, "--compare", "F", "h.png" },
	{ "rm-info", SMALL, "--sheet", "out.png", "F", "h.png" },
	{ "rm-info", SMALL, "--normal", "F", "--depth", "h.png" },
	{ "rm-pack", SMALL, "--unpack", "F", "--normal-out", "out.png",
	    "--depth-out", "out.tga", "--ao-out", "out.exr" },
	{ "rm-pack", SMALL, "--depth", "F", "--quality", "preview", "-o",
	    "out.exr" },
	{ "rm-pack", SMALL, "--normal", "F", "--ao", "none", "-o", "out.tiff" },
	{ "rm-pack", SMALL, "--normal", "F", "--depth", "h.png", "--target",
	    "unity-urp", "-o", "out.png" },
	{ "rm-aobake", SMALL, "-n", "4", "--quality", "preview", "F", "-o",
	    "out.png" },
	{ "rm-aobake", SMALL, "-n", "4", "--dequantize", "--horizons",
	    "out.exr", "F", "-o", "out.png" },
	{ "rm-rescale-ao", SMALL, "--scale", "2", "F", "-o", "out.png" },
	{ "rm-rescale-ao", SMALL, "--scale", "2", "--horizons", "F", "-o",
	    "out.png" },
	{ "rm-combine", SMALL, "F", "-w", "0.5", "F", "-o", "out.png" },
	{ "rm-combine", SMALL, "--color", "F", "h.png", "F", "--color-out",
	    "out.exr", "-o", "out.png" },
	{ "rm-roughen", SMALL, "--angle", "30", "F", "-o", "out.png" },
	{ "rm-roughen", SMALL, "--normal-map", "F", "--light", "0,0,1", "h.png",
	    "-o", "out.png" },
	{ "rm-roughen", SMALL, "--angle-map", "F", "h.png", "-o", "out.png" },
	{ "rm-roughen", SMALL, "--fit", "F", "h.png" },
	{ RENDER, "--detail", "4", "--shape", "cylinder", "--quadric", "F.tsv",
	    "--paint", "a" },
	{ RENDER, "--detail", "4", "F" },
	{ RENDER, "--multilayer", "F.exr" },
	{ RENDER, "--impostor", "F.exr" },
	{ RENDER, "--horizons", "F", "-s", "0.1", "h.png" },
	{ RENDER, "--color", "F", "--ground", "F" },
	{ RENDER, "--shape", "F.obj", "h.png" },
	{ "rm-multilayer", SMALL, "--size", "8x8", "--solidify", "0.1", "F.obj",
	    "-o", "out" },
	{ "rm-multilayer", SMALL, "--size", "8x8", "--deep", "F.gltf", "-o",
	    "out" },
	{ "rm-multilayer", SMALL, "--from-depth", "F", "-o", "out" },
	{ "rm-quadfit", "F.obj", "--frame", "auto", "-o", "out.tsv",
	    "--stats" },
	{ "rm-quadfit", "F.ply", "--frame", "auto", "-o", "out.glb" },
	{ "rm-quadfit", "F.gltf", "--frame", "auto", "-o", "out.gltf" },
	{ "rm-aobake", SMALL, "--if-changed", "h.png", "-o", "F.png" },
	{ "rm-pack", SMALL, "--if-changed", "--depth", "h.png", "-o", "F.png" },
};
enum { NCOMMANDS = sizeof commands / sizeof *commands, MAX_ARGS = 24 };

static char *folder;

static void
remove_jail(void)
{
	char *command;

	if (asprintf(&command, "rm -rf '%s'", folder) < 0 ||
	    system(command) != 0)
		perror(folder);
	free(command);
}

/* An 8x8 height ramp for tools that want another file. */
static void
write_height(int jail)
{
	static const char head[] = "P5 8 8 255\n";
	int fd = openat(jail, "h.png", O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
	unsigned char texel[64];

	for (int i = 0; i < 64; i++)
		texel[i] = (unsigned char)(i * 4);
	if (fd < 0 || write(fd, head, sizeof head - 1) < 0 ||
	    write(fd, texel, sizeof texel) < 0)
		abort();
	close(fd);
}

int
LLVMFuzzerInitialize(int *argc, char ***argv)
{
	int jail;

	(void)argc, (void)argv;
	folder = fuzz_make_folder();
	jail = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	fuzz_open_jail(jail);
	write_height(jail);
	atexit(remove_jail);
	return 0;
}

/* The file, and the command line with its name in it. */
static int
make_line(const char *const command[MAX_ARGS], char *argv[MAX_ARGS + 1],
    char file[16])
{
	int n = 0;

	snprintf(file, 16, "F");
	for (; n < MAX_ARGS && command[n] != NULL; n++) {
		if (command[n][0] == 'F')
			snprintf(file, 16, "%s", command[n]);
		if ((argv[n] = strdup(command[n])) == NULL)
			abort();
	}
	argv[n] = NULL;
	return n;
}

static void
put_file(const char *name, const uint8_t *bytes, size_t size)
{
	int fd = openat(
	    fuzz_jail, name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);

	if (fd < 0 || write(fd, bytes, size) != (ssize_t)size)
		abort();
	close(fd);
}

int
LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	char *argv[MAX_ARGS + 1], file[16];
	int which, argc;

	if (size < 2 || bytes[0] < 'A' || bytes[0] >= 'A' + NCOMMANDS)
		return -1;
	which = bytes[0] - 'A';
	argc = make_line(commands[which], argv, file);
	put_file(file, bytes + 1, size - 1);
	fuzz_most_bytes = 1 << 20;
	for (int i = 0; i < FUZZ_NTOOLS; i++)
		if (strcmp(fuzz_tools[i].name, argv[0]) == 0)
			fuzz_run(fuzz_tools[i].main, argc, argv);
	fuzz_most_bytes = SIZE_MAX;
	unlinkat(fuzz_jail, file, 0);
	for (int i = 0; i < argc; i++)
		free(argv[i]);
	return 0;
}
