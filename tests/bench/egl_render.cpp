// Times bench_render's plane as a fragment shader on Mesa's llvmpipe.
// SPDX-License-Identifier: MIT
//
//	c++ -O3 -std=c++17 tests/bench/egl_render.cpp -lEGL -lGLESv2
//	bench_render --write relief.rgba
//	LIBGL_ALWAYS_SOFTWARE=1 LP_NUM_THREADS=0 a.out relief.rgba 256
//
// Arguments: the relief's bytes and its side. Not built by make, as EGL and
// OpenGL ES 3 are needed for this comparison alone; scripts/bench builds and
// runs it where they are installed. Linear and binary search as Policarpo,
// Oliveira and Comba have them (2005), with the linear search ended at the
// first place below the relief and without (llvmpipe's lanes wait for the
// last), then normal, occlusion, Lambert and Blinn-Phong. A frame's CPU time
// is the whole process's, from its first command to glFinish. -o FILE (last)
// writes the picture, a PPM.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

enum { WIDTH = 640, HEIGHT = 480, NRUNS = 9 };

static const char vertex_shader[] = R"(#version 300 es
uniform mat4 to_clip;
in vec2 at; // x and z in the plane
out vec2 uv;
out vec3 position;
void main()
{
	position = vec3(at.x, 0.0, at.y);
	uv = 4.0 * vec2(0.5 + at.x / 8.0, 0.5 - at.y / 8.0);
	gl_Position = to_clip * vec4(position, 1.0);
}
)";

static const char fragment_shader[] = R"(#version 300 es
precision highp float;
uniform sampler2D relief; // normal x and y, occlusion, depth
uniform vec3 eye, light;
in vec2 uv;
in vec3 position;
out vec4 color;
const float depth = 0.2;

float
below(vec3 p)
{
	return p.z - texture(relief, p.xy).w;
}

void main()
{
	vec3 v = normalize(position - eye);
	// per depth 1: the texture's width is 2, tangent x, bitangent -z
	vec3 step = vec3(v.x, -v.z, 2.0) * vec3(depth / (-v.y * 2.0),
	    depth / (-v.y * 2.0), 0.5);
	vec3 p = vec3(uv, 0.0), delta = step / 32.0;
#ifdef EARLY
	for (int i = 0; i < 32; i++) {
		p += delta;
		if (below(p) >= 0.0)
			break;
	}
#else
	vec3 found = p + step;
	bool done = false;
	for (int i = 0; i < 32; i++) {
		p += delta;
		bool now = !done && below(p) >= 0.0;
		found = now ? p : found;
		done = done || now;
	}
	p = found;
#endif
	for (int i = 0; i < 6; i++) {
		delta *= 0.5;
		p += below(p) >= 0.0 ? -delta : delta;
	}
	vec4 t = texture(relief, p.xy);
	vec2 xy = 2.0 * t.xy - 1.0;
	vec3 n = vec3(xy.x, sqrt(max(0.0, 1.0 - dot(xy, xy))), -xy.y);
	vec3 l = normalize(light), h = normalize(l - v);
	float diffuse = max(0.0, dot(n, l));
	float gloss = diffuse > 0.0
	    ? 0.1 * pow(max(0.0, dot(n, h)), 40.0) : 0.0;
	color = vec4(vec3(0.6 * (0.3 * t.z + diffuse) + gloss), 1.0);
}
)";

[[noreturn]] static void
die(const char *what)
{
	std::fprintf(stderr, "egl_render: %s\n", what);
	std::exit(1);
}

static double
cpu_ms()
{
	timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return 1e3 * static_cast<double>(t.tv_sec) +
	       1e-6 * static_cast<double>(t.tv_nsec);
}

static void
open_context()
{
	const EGLint any[] = { EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT,
		EGL_SURFACE_TYPE, 0, EGL_NONE };
	const EGLint version[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE };
	EGLDisplay display = eglGetPlatformDisplay(
	    EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
	EGLConfig config = nullptr;
	EGLint n = 0;

	if (!eglInitialize(display, nullptr, nullptr) ||
	    !eglBindAPI(EGL_OPENGL_ES_API))
		die("no surfaceless EGL");
	(void)eglChooseConfig(display, any, &config, 1, &n);
	EGLContext context = eglCreateContext(display,
	    n > 0 ? config : EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version);
	if (context == EGL_NO_CONTEXT ||
	    !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
		die("no context of OpenGL ES 3");
}

static GLuint
compile(GLenum kind, const std::string &text)
{
	const GLuint s = glCreateShader(kind);
	const char *p = text.c_str();
	char log[1024] = "";
	GLint ok;

	glShaderSource(s, 1, &p, nullptr);
	glCompileShader(s);
	glGetShaderiv(s, GL_COMPILE_STATUS, &ok);
	glGetShaderInfoLog(s, sizeof log, nullptr, log);
	if (!ok)
		die(log);
	return s;
}

static void
load_relief(const char *path, int side)
{
	std::vector<unsigned char> bytes(
	    static_cast<size_t>(side) * static_cast<size_t>(side) * 4);
	std::FILE *f = std::fopen(path, "rb");
	GLuint texture;

	if (f == nullptr ||
	    std::fread(bytes.data(), 1, bytes.size(), f) != bytes.size())
		die("cannot read the relief");
	std::fclose(f);
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, side, side, 0, GL_RGBA,
	    GL_UNSIGNED_BYTE, bytes.data());
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

static void
open_target()
{
	GLuint frame, color;

	glGenFramebuffers(1, &frame);
	glBindFramebuffer(GL_FRAMEBUFFER, frame);
	glGenRenderbuffers(1, &color);
	glBindRenderbuffer(GL_RENDERBUFFER, color);
	glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, WIDTH, HEIGHT);
	glFramebufferRenderbuffer(
	    GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
	if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		die("no frame buffer");
	glViewport(0, 0, WIDTH, HEIGHT);
}

// The camera of bench_render: 4 away at 35 degrees, 12 degrees high.
static void
set_camera(GLuint program)
{
	const double a = std::acos(-1.0) * 35 / 180, f = 4;
	const double c = std::cos(a), s = std::sin(a);
	const double focal = 1 / std::tan(std::acos(-1.0) * 6 / 180);
	const double near = 0.1, far = 100;
	// rows: clip x, y, z, w of (x, y, z, 1); depth along the view is
	// f - s y - c z
	const double m[4][4] = {
		{ focal * HEIGHT / WIDTH, 0, 0, 0 },
		{ 0, focal * c, -focal * s, 0 },
		{ 0, -s * (far + near) / (far - near),
		    -c * (far + near) / (far - near),
		    f * (far + near) / (far - near) -
			2 * far * near / (far - near) },
		{ 0, -s, -c, f },
	};
	GLfloat columns[16];

	for (int i = 0; i < 16; i++)
		columns[i] = static_cast<GLfloat>(m[i % 4][i / 4]);
	glUniformMatrix4fv(
	    glGetUniformLocation(program, "to_clip"), 1, GL_FALSE, columns);
	glUniform3f(glGetUniformLocation(program, "eye"), 0,
	    static_cast<float>(f * s), static_cast<float>(f * c));
	glUniform3f(glGetUniformLocation(program, "light"), -1, 2, 1.5f);
}

static void
time_shader(const char *name, const char *define)
{
	const GLfloat square[] = { -4, 4, 4, 4, -4, -4, 4, -4 };
	const std::string text(fragment_shader);
	const size_t line = text.find('\n') + 1;
	const GLuint program = glCreateProgram();
	std::vector<double> ms;
	GLint ok;

	glAttachShader(program, compile(GL_VERTEX_SHADER, vertex_shader));
	glAttachShader(
	    program, compile(GL_FRAGMENT_SHADER,
			 text.substr(0, line) + define + text.substr(line)));
	glBindAttribLocation(program, 0, "at");
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &ok);
	if (!ok)
		die("the shader does not link");
	glUseProgram(program);
	set_camera(program);
	glEnableVertexAttribArray(0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, square);
	for (int i = 0; i <= NRUNS; i++) {
		const double start = cpu_ms();

		glClear(GL_COLOR_BUFFER_BIT);
		glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
		glFinish();
		if (i > 0) // the first one compiles
			ms.push_back(cpu_ms() - start);
	}
	std::sort(ms.begin(), ms.end());
	std::printf("%s, %s, CPU ms\t%.2f\t%.2f\n",
	    reinterpret_cast<const char *>(glGetString(GL_RENDERER)), name,
	    ms[0], ms[NRUNS / 2]);
}

static void
write_picture(const char *path)
{
	std::vector<unsigned char> rgba(
	    static_cast<size_t>(WIDTH) * HEIGHT * 4);
	std::FILE *f = std::fopen(path, "wb");

	glReadPixels(
	    0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
	if (f == nullptr)
		die(path);
	std::fprintf(f, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
	for (size_t y = HEIGHT; y-- > 0;)
		for (size_t x = 0; x < WIDTH; x++)
			std::fwrite(&rgba[(y * WIDTH + x) * 4], 1, 3, f);
	std::fclose(f);
}

int
main(int argc, char **argv)
{
	if (argc != 3 && argc != 5) {
		std::fprintf(
		    stderr, "usage: egl_render RELIEF SIDE [-o FILE]\n");
		return 2;
	}
	open_context();
	load_relief(argv[1], std::atoi(argv[2]));
	open_target();
	time_shader("whole linear search", "\n");
	time_shader("ended linear search", "#define EARLY\n");
	if (argc == 5)
		write_picture(argv[4]);
	return 0;
}
