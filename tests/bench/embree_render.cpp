// Ray-traces displaced geometry with Embree: what rm-render ought to show.
// SPDX-License-Identifier: MIT
//
//	c++ -O3 -std=c++17 -fopenmp -Ilibbake tests/bench/embree_render.cpp
//	    libbake.a -lembree3 (and the libraries of libbake)
//
// Takes rm-render's words --size --camera (six numbers) --fov --light --ambient
// --detail and, for each object, --shape --relief --depth --repeat --scale
// --rotate --translate --base-color; -o FILE writes buffers as --buffers does.
// --against FILE, as often as wanted, prints how far such a file is from it.
// Not built by make; scripts/bench builds it where Embree is installed.
//
// From libbake are only the inputs: meshes, their corner normals and tangents,
// image files. The relief is
//   plane   its bilinear patches, each a primitive of Embree's that is met by
//           a quadratic in double; it goes on without end below the square at
//           which rays come in, as rm-render without silhouettes has it
//   others  P - D d(u, v) N, tessellated: each triangle of the mesh cut along
//           the lines between texel centres and these cells' diagonals, then
//           --split times each way; the largest distance from the surface to
//           its triangles' middles is printed. Their backs are not seen;
//           those of meshes without relief are, through the open ends of
//           tubes that an impostor has solid
// Colour is Lambert's law and ambient light times the packed occlusion.
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "io_image.h"
#include "mesh.h"
#include "mesh_frame.h"
#include "shape.h"

using Vec = std::array<double, 3>;

static Vec
operator+(const Vec &a, const Vec &b)
{
	return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}

static Vec
operator-(const Vec &a, const Vec &b)
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

static Vec
operator*(double k, const Vec &a)
{
	return { k * a[0], k * a[1], k * a[2] };
}

static double
dot(const Vec &a, const Vec &b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static Vec
cross(const Vec &a, const Vec &b)
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
		a[0] * b[1] - a[1] * b[0] };
}

static Vec
unit(const Vec &a)
{
	const double n = std::sqrt(dot(a, a));

	return n > 0 ? 1 / n * a : a;
}

static Vec
vec(const double *p)
{
	return { p[0], p[1], p[2] };
}

[[noreturn]] static void
die(const std::string &why)
{
	std::fprintf(stderr, "embree_render: %s\n", why.c_str());
	std::exit(1);
}

// -- inputs -----------------------------------------------------------------

struct Picture {
	bake_image img = BAKE_IMAGE_INIT;
	bake_image_info info;

	explicit Picture(const std::string &path)
	{
		const bake_read_limits limits = BAKE_READ_LIMITS_DEFAULT;
		bake_reader *reader = nullptr;
		bake_err err = BAKE_ERR_INIT;

		if (bake_reader_open(&reader, path.c_str(), &limits, &info,
			&err) != BAKE_OK ||
		    bake_reader_read(reader, 0, info.nchans, &img, &err) !=
			BAKE_OK)
			die(path + ": " + err.msg);
		bake_reader_close(reader);
	}
	~Picture()
	{
		bake_image_free(&img);
	}
	Picture(const Picture &) = delete;

	double
	at(long x, long y, int c) const
	{
		x = (x % img.width + img.width) % img.width;
		y = (y % img.height + img.height) % img.height;
		return static_cast<double>(
		    img.data[static_cast<size_t>(y) * img.row_stride +
			     static_cast<size_t>(x * img.nchans + c)]);
	}
	// bilinear between texel centres; v grows upwards
	double
	sample(double u, double v, int c) const
	{
		const double x = u * img.width - 0.5;
		const double y = (1 - v) * img.height - 0.5;
		const double i = std::floor(x), j = std::floor(y);
		const double a = x - i, b = y - j;
		const long xi = static_cast<long>(i), yi = static_cast<long>(j);

		return (1 - b) *
			   ((1 - a) * at(xi, yi, c) + a * at(xi + 1, yi, c)) +
		       b * ((1 - a) * at(xi, yi + 1, c) +
			       a * at(xi + 1, yi + 1, c));
	}
	int
	channel(const char *name) const
	{
		for (int c = 0; c < info.nchans; c++)
			if (std::strcmp(info.names[c], name) == 0)
				return c;
		die(std::string("no channel ") + name);
	}
};

struct Object {
	std::string shape;               // empty: the plane
	std::unique_ptr<Picture> relief; // normal x, y, AO, depth
	double depth = 0.1, repeat = 1, scale = 1;
	Vec rotate{ 0, 0, 0 }, translate{ 0, 0, 0 }, base{ 0.6, 0.6, 0.6 };
	bake_mesh mesh = {};
	bake_frames frames = {};
	RTCScene scene = nullptr;
	bool flat = false;
	// of a tessellation: the mesh's triangle, and weights 1 and 2 of
	// corners
	std::vector<int> triangle;
	std::vector<std::array<std::array<float, 2>, 3>> weights;
};

static Vec
turned(const Vec &degrees, Vec p)
{
	for (size_t axis = 0; axis < 3; axis++) {
		const size_t i = (axis + 1) % 3, k = (axis + 2) % 3;
		const double a = degrees[axis] * std::acos(-1.0) / 180;
		const double x = p[i], y = p[k];

		p[i] = std::cos(a) * x - std::sin(a) * y;
		p[k] = std::sin(a) * x + std::cos(a) * y;
	}
	return p;
}

static void
load_mesh(Object &o, int detail)
{
	const bake_mesh_params params = BAKE_MESH_PARAMS_DEFAULT;
	bake_frame_params how = BAKE_FRAME_PARAMS_DEFAULT;
	bake_weld weld = {};
	bake_err err = BAKE_ERR_INIT;
	bake_shape shape;
	bake_status rc;

	how.tangents = BAKE_TANGENTS_FILE;
	if (bake_shape_from_name(o.shape.c_str(), &shape))
		rc = bake_shape_make(shape, detail, &o.mesh, &err);
	else {
		rc = bake_mesh_read(o.shape.c_str(), &params, &o.mesh, &err);
		how.tangents = BAKE_TANGENTS_AUTO;
	}
	if (rc != BAKE_OK)
		die(err.msg);
	for (size_t v = 0; v < o.mesh.npositions; v++) {
		const Vec p =
		    turned(o.rotate, o.scale * vec(o.mesh.positions[v])) +
		    o.translate;

		std::copy(p.begin(), p.end(), o.mesh.positions[v]);
	}
	for (size_t v = 0; v < o.mesh.nnormals; v++) {
		const Vec n = turned(o.rotate, vec(o.mesh.normals[v]));

		std::copy(n.begin(), n.end(), o.mesh.normals[v]);
		if (o.mesh.tangents != nullptr) {
			const Vec t = turned(o.rotate, vec(o.mesh.tangents[v]));

			std::copy(t.begin(), t.end(), o.mesh.tangents[v]);
		}
	}
	if (bake_mesh_weld(&o.mesh, 0, &weld, &err) != BAKE_OK ||
	    bake_mesh_frames(&o.mesh, &weld, nullptr, &how, &o.frames, &err) !=
		BAKE_OK)
		die(err.msg);
	bake_weld_free(&weld);
	o.flat = o.shape == "plane" && o.relief;
}

// A triangle of the mesh, in double: corners, displacement for depth 1, UVs of
// the repeated texture.
struct Corners {
	Vec p[3], down[3];
	double uv[3][2];
};

static Corners
corners_of(const Object &o, size_t t)
{
	Corners c;

	for (int k = 0; k < 3; k++) {
		const bake_corner &at = o.mesh.triangles[t][k];
		const bake_frame &f = o.frames.frame[o.frames.frame_of[t][k]];

		c.p[k] = vec(o.mesh.positions[at.v]);
		c.down[k] = -o.depth * vec(f.normal);
		for (int i = 0; i < 2; i++)
			c.uv[k][i] =
			    at.vt < 0 ? 0 : o.mesh.uvs[at.vt][i] * o.repeat;
	}
	return c;
}

// -- a plane: bilinear patches ----------------------------------------------

// The ray in texels from texel centre to texel centre, y downwards.
struct PatchRay {
	RTCIntersectContext embree; // first: Embree hands back its address
	double p[3], d[3];
	double t;
};

static void
patch_bounds(const RTCBoundsFunctionArguments *args)
{
	const auto *map = static_cast<const Picture *>(args->geometryUserPtr);
	const long x = args->primID % static_cast<unsigned>(map->img.width);
	const long y = args->primID / static_cast<unsigned>(map->img.width);
	double lo = 1e30, hi = -1e30;

	for (int k = 0; k < 4; k++) {
		const double d = map->at(x + k % 2, y + k / 2, 3);

		lo = std::min(lo, d);
		hi = std::max(hi, d);
	}
	// more than what floats of up to 4096 lose
	args->bounds_o->lower_x = static_cast<float>(x) - 1e-2f;
	args->bounds_o->lower_y = static_cast<float>(y) - 1e-2f;
	args->bounds_o->lower_z = static_cast<float>(lo) - 1e-5f;
	args->bounds_o->upper_x = static_cast<float>(x) + 1.01f;
	args->bounds_o->upper_y = static_cast<float>(y) + 1.01f;
	args->bounds_o->upper_z = static_cast<float>(hi) + 1e-5f;
}

// The first t in from .. to where a + b t + c t^2 >= 0; infinity for none.
static double
first_inside(double a, double b, double c, double from, double to)
{
	const auto f = [=](double t) { return a + t * (b + t * c); };
	const double none = std::numeric_limits<double>::infinity();
	const double disc = b * b - 4 * a * c;
	double best = f(to) >= 0 ? to : none;

	if (f(from) >= 0)
		return from;
	if (disc >= 0) {
		const double q = -0.5 * (b + std::copysign(std::sqrt(disc), b));

		for (double t : { q / c, a / q })
			if (t >= from && t <= to)
				best = std::min(best, t);
	}
	return best;
}

static void
patch_intersect(const RTCIntersectFunctionNArguments *args)
{
	const auto *map = static_cast<const Picture *>(args->geometryUserPtr);
	auto *ray = reinterpret_cast<PatchRay *>(args->context);
	auto *rh = reinterpret_cast<RTCRayHit *>(args->rayhit);
	const long x = args->primID % static_cast<unsigned>(map->img.width);
	const long y = args->primID / static_cast<unsigned>(map->img.width);
	const double at[2] = { static_cast<double>(x), static_cast<double>(y) };
	double from = 0, to = 1e300;

	if (args->valid[0] == 0)
		return;
	for (int k = 0; k < 2; k++) {
		double a = (at[k] - ray->p[k]) / ray->d[k];
		double b = (at[k] + 1 - ray->p[k]) / ray->d[k];

		if (ray->d[k] == 0) {
			if (ray->p[k] < at[k] || ray->p[k] > at[k] + 1)
				return;
			continue;
		}
		from = std::max(from, std::min(a, b));
		to = std::min(to, std::max(a, b));
	}
	if (!(from <= to))
		return;
	const double d00 = map->at(x, y, 3), d10 = map->at(x + 1, y, 3);
	const double d01 = map->at(x, y + 1, 3), d11 = map->at(x + 1, y + 1, 3);
	const double ax = d10 - d00, ay = d01 - d00;
	const double axy = d11 - d10 - d01 + d00;
	const double fx = ray->p[0] - at[0], fy = ray->p[1] - at[1];
	const double t =
	    first_inside(ray->p[2] - d00 - ax * fx - ay * fy - axy * fx * fy,
		ray->d[2] - ax * ray->d[0] - ay * ray->d[1] -
		    axy * (fx * ray->d[1] + fy * ray->d[0]),
		-axy * ray->d[0] * ray->d[1], from, to);

	if (!(t < ray->t))
		return;
	ray->t = t;
	// a little more, lest the next patch's equal t be passed over
	rh->ray.tfar = static_cast<float>(t * (1 + 1e-6) + 1e-9);
	rh->hit.geomID = args->geomID;
	rh->hit.primID = args->primID;
}

static void
build_patches(RTCDevice device, Object &o)
{
	RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
	const bake_image &img = o.relief->img;

	o.scene = rtcNewScene(device);
	rtcSetGeometryUserPrimitiveCount(
	    g, static_cast<unsigned>(img.width * img.height));
	rtcSetGeometryUserData(g, o.relief.get());
	rtcSetGeometryBoundsFunction(g, patch_bounds, nullptr);
	rtcSetGeometryIntersectFunction(g, patch_intersect);
	rtcCommitGeometry(g);
	rtcAttachGeometry(o.scene, g);
	rtcReleaseGeometry(g);
	rtcSetSceneFlags(o.scene, RTC_SCENE_FLAG_ROBUST);
	rtcCommitScene(o.scene);
}

// -- other meshes: a tessellation -------------------------------------------

struct Builder {
	Object *o;
	int split;
	double worst = 0;
	std::vector<float> positions;
};

using Bary = std::array<double, 2>; // weights of corners 1 and 2

static std::array<double, 2>
uv_of(const Corners &c, const Bary &b)
{
	std::array<double, 2> uv;

	for (size_t i = 0; i < 2; i++)
		uv[i] = (1 - b[0] - b[1]) * c.uv[0][i] + b[0] * c.uv[1][i] +
			b[1] * c.uv[2][i];
	return uv;
}

static Vec
surface(const Object &o, const Corners &c, const Bary &b)
{
	const double w = 1 - b[0] - b[1];
	const Vec p = w * c.p[0] + b[0] * c.p[1] + b[1] * c.p[2];
	const Vec n = w * c.down[0] + b[0] * c.down[1] + b[1] * c.down[2];

	if (!o.relief)
		return p;
	const auto uv = uv_of(c, b);
	return p + o.relief->sample(uv[0], uv[1], 3) * n;
}

static void
add_triangle(Builder &to, const Corners &c, size_t t, const Bary &a,
    const Bary &b, const Bary &d)
{
	const Bary at[3] = { a, b, d };
	Vec p[3];

	to.o->triangle.push_back(static_cast<int>(t));
	to.o->weights.emplace_back();
	for (size_t k = 0; k < 3; k++) {
		p[k] = surface(*to.o, c, at[k]);
		for (size_t i = 0; i < 3; i++)
			to.positions.push_back(static_cast<float>(p[k][i]));
		for (size_t i = 0; i < 2; i++)
			to.o->weights.back()[k][i] =
			    static_cast<float>(at[k][i]);
	}
	if (t % 64 == 0) {
		const Bary mid = { (a[0] + b[0] + d[0]) / 3,
			(a[1] + b[1] + d[1]) / 3 };
		const Vec e =
		    surface(*to.o, c, mid) - 1.0 / 3 * (p[0] + p[1] + p[2]);

		to.worst = std::max(to.worst, std::sqrt(dot(e, e)));
	}
}

// A triangle, `split` times each way.
static void
add_split(Builder &to, const Corners &c, size_t t, const Bary &a, const Bary &b,
    const Bary &d)
{
	const int n = to.split;
	const auto at = [&](int i, int k) -> Bary {
		const double x = static_cast<double>(i) / n;
		const double y = static_cast<double>(k) / n;

		return { a[0] + x * (b[0] - a[0]) + y * (d[0] - a[0]),
			a[1] + x * (b[1] - a[1]) + y * (d[1] - a[1]) };
	};

	for (int i = 0; i < n; i++)
		for (int k = 0; i + k < n; k++) {
			add_triangle(
			    to, c, t, at(i, k), at(i + 1, k), at(i, k + 1));
			if (i + k + 1 < n)
				add_triangle(to, c, t, at(i + 1, k),
				    at(i + 1, k + 1), at(i, k + 1));
		}
}

// The part of a polygon where g >= 0, g being affine.
template <class G>
static std::vector<Bary>
clip(const std::vector<Bary> &in, const G &g)
{
	std::vector<Bary> out;

	for (size_t i = 0; i < in.size(); i++) {
		const Bary &a = in[i], &b = in[(i + 1) % in.size()];
		const double ga = g(a), gb = g(b);

		if (ga >= 0)
			out.push_back(a);
		if ((ga < 0) != (gb < 0)) {
			const double s = ga / (ga - gb);

			out.push_back({ a[0] + s * (b[0] - a[0]),
			    a[1] + s * (b[1] - a[1]) });
		}
	}
	return out;
}

static void
add_cells(Builder &to, const Corners &c, size_t t)
{
	const bake_image &img = to.o->relief->img;
	const auto cell = [&](const Bary &b, size_t axis) {
		const auto uv = uv_of(c, b);

		return axis == 0 ? uv[0] * img.width - 0.5
				 : uv[1] * img.height - 0.5;
	};
	const std::vector<Bary> whole = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
	const auto range = [&](const std::vector<Bary> &p, size_t axis,
			       long r[2]) {
		double lo = 1e300, hi = -1e300;

		for (const Bary &b : p) {
			lo = std::min(lo, cell(b, axis));
			hi = std::max(hi, cell(b, axis));
		}
		r[0] = static_cast<long>(std::floor(lo));
		r[1] = static_cast<long>(std::ceil(hi));
	};
	long rx[2], ry[2];

	range(whole, 0, rx);
	for (long x = rx[0]; x < rx[1]; x++) {
		auto strip = clip(whole, [&](const Bary &b) {
			return cell(b, 0) - static_cast<double>(x);
		});
		strip = clip(strip, [&](const Bary &b) {
			return static_cast<double>(x + 1) - cell(b, 0);
		});
		if (strip.size() < 3)
			continue;
		range(strip, 1, ry);
		for (long y = ry[0]; y < ry[1]; y++) {
			auto piece = clip(strip, [&](const Bary &b) {
				return cell(b, 1) - static_cast<double>(y);
			});
			piece = clip(piece, [&](const Bary &b) {
				return static_cast<double>(y + 1) - cell(b, 1);
			});
			for (size_t k = 2; k < piece.size(); k++)
				add_split(
				    to, c, t, piece[0], piece[k - 1], piece[k]);
		}
	}
}

// What a ray meets from behind is not there: the surface is closed.
static void
drop_backs(const RTCFilterFunctionNArguments *args)
{
	const auto *ray = reinterpret_cast<const RTCRay *>(args->ray);
	const auto *hit = reinterpret_cast<const RTCHit *>(args->hit);

	if (hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y +
		hit->Ng_z * ray->dir_z >
	    0)
		args->valid[0] = 0;
}

static void
build_triangles(RTCDevice device, Object &o, int split)
{
	Builder to{ &o, split, 0, {} };
	RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);

	for (size_t t = 0; t < o.mesh.ntriangles; t++) {
		const Corners c = corners_of(o, t);

		if (o.relief)
			add_cells(to, c, t);
		else
			add_triangle(to, c, t, { 0, 0 }, { 1, 0 }, { 0, 1 });
	}
	const size_t n = o.triangle.size();
	auto *index = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
	    g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n));

	for (size_t i = 0; i < 3 * n; i++)
		index[i] = static_cast<unsigned>(i);
	std::copy(to.positions.begin(), to.positions.end(),
	    static_cast<float *>(rtcSetNewGeometryBuffer(
		g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * n)));
	if (o.relief)
		rtcSetGeometryIntersectFilterFunction(g, drop_backs);
	rtcCommitGeometry(g);
	o.scene = rtcNewScene(device);
	rtcAttachGeometry(o.scene, g);
	rtcReleaseGeometry(g);
	rtcSetSceneFlags(
	    o.scene, static_cast<RTCSceneFlags>(
			 RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT));
	rtcCommitScene(o.scene);
	if (o.relief)
		std::printf(
		    "%s\t%zu triangles, off by at most %.2g of the range\n",
		    o.shape.c_str(), n, to.worst / o.depth);
}

// -- rays -------------------------------------------------------------------

struct Ray {
	Vec from, dir;
};

// What a ray meets: t along it, and the surface there.
struct Hit {
	double t = std::numeric_limits<double>::infinity();
	const Object *o = nullptr;
	double u = 0, v = 0, ao = 1;
	double per_depth = 1; // change of the relief's depth by t
	Vec n{ 0, 0, 0 };
};

// The relief's normal in world space, and its occlusion, at h.u, h.v.
static void
look_up(Hit &h, size_t triangle, const Bary &b)
{
	const Object &o = *h.o;
	const double w[3] = { 1 - b[0] - b[1], b[0], b[1] };
	Vec n{ 0, 0, 0 }, t{ 0, 0, 0 };
	int hand = 1;

	for (int k = 0; k < 3; k++) {
		const bake_frame &f =
		    o.frames.frame[o.frames.frame_of[triangle][k]];

		n = n + w[k] * vec(f.normal);
		t = t + w[k] * vec(f.tangent);
		hand = f.hand;
	}
	n = unit(n);
	t = unit(t - dot(t, n) * n);
	h.n = n;
	if (!o.relief)
		return;
	const double x = 2 * o.relief->sample(h.u, h.v, 0) - 1;
	const double y = 2 * o.relief->sample(h.u, h.v, 1) - 1;
	const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));

	h.ao = o.relief->sample(h.u, h.v, 2);
	h.n = unit(x * t + y * (hand * cross(n, t)) + z * n);
}

// Where a ray meets a triangle's plane from the front; whether inside of it.
static bool
meet(const Corners &c, const Ray &r, double &t, Bary &b)
{
	const Vec e = c.p[1] - c.p[0], f = c.p[2] - c.p[0];
	const Vec n = cross(e, f), s = r.from - c.p[0];
	const double det = -dot(n, r.dir);

	if (!(det > 0))
		return false;
	t = dot(n, s) / det;
	const Vec at = r.from + t * r.dir - c.p[0];
	const double nn = dot(n, n);

	b[0] = dot(cross(at, f), n) / nn;
	b[1] = dot(cross(e, at), n) / nn;
	return t > 0 && b[0] >= 0 && b[1] >= 0 && b[0] + b[1] <= 1;
}

// A ray that is on the plane at the start into the endless relief.
static double
trace_patches(const Object &o, const double p[3], const double d[3])
{
	const double side[2] = { static_cast<double>(o.relief->img.width),
		static_cast<double>(o.relief->img.height) };
	const double end = (1 + 1e-9) / d[2];
	double best = std::numeric_limits<double>::infinity();
	double lo[2], hi[2];

	for (int k = 0; k < 2; k++) {
		const double a = p[k], b = p[k] + end * d[k];

		lo[k] = std::floor(std::min(a, b) / side[k]);
		hi[k] = std::floor(std::max(a, b) / side[k]);
	}
	for (double y = lo[1]; y <= hi[1]; y++)
		for (double x = lo[0]; x <= hi[0]; x++) {
			PatchRay r;
			RTCRayHit rh = {};

			rtcInitIntersectContext(&r.embree);
			r.p[0] = p[0] - x * side[0];
			r.p[1] = p[1] - y * side[1];
			r.p[2] = p[2];
			std::copy(d, d + 3, r.d);
			r.t = best;
			rh.ray.org_x = static_cast<float>(r.p[0]);
			rh.ray.org_y = static_cast<float>(r.p[1]);
			rh.ray.org_z = static_cast<float>(r.p[2]);
			rh.ray.dir_x = static_cast<float>(d[0]);
			rh.ray.dir_y = static_cast<float>(d[1]);
			rh.ray.dir_z = static_cast<float>(d[2]);
			rh.ray.tfar = static_cast<float>(end * 1.01);
			rh.ray.mask = ~0u;
			rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
			rtcIntersect1(o.scene, &r.embree, &rh);
			best = r.t;
		}
	return best;
}

static void
meet_plane(const Object &o, const Ray &r, Hit &best)
{
	for (size_t k = 0; k < o.mesh.ntriangles; k++) {
		const Corners c = corners_of(o, k);
		const bake_image &img = o.relief->img;
		double start;
		Bary b;

		if (!meet(c, r, start, b))
			continue;
		// weights after one unit of length, by an affine map
		const Vec n = unit(cross(c.p[1] - c.p[0], c.p[2] - c.p[0]));
		const double down = -dot(n, r.dir);
		const Vec side = r.dir + down * n;
		const Vec at = c.p[0] + b[0] * (c.p[1] - c.p[0]) +
			       b[1] * (c.p[2] - c.p[0]);
		const Ray next = { at + side + n, -1.0 * n };
		double unused;
		Bary b1;

		(void)meet(c, next, unused, b1);
		const auto uv = uv_of(c, b), uv1 = uv_of(c, b1);
		const double p[3] = { uv[0] * img.width - 0.5,
			(1 - uv[1]) * img.height - 0.5, 0 };
		const double d[3] = { (uv1[0] - uv[0]) * img.width,
			(uv[1] - uv1[1]) * img.height, down / o.depth };
		const double t = trace_patches(o, p, d);

		if (!(start + t < best.t))
			return;
		best.t = start + t;
		best.o = &o;
		best.u = uv[0] + t * (uv1[0] - uv[0]);
		best.v = uv[1] + t * (uv1[1] - uv[1]);
		best.per_depth = d[2];
		look_up(best, k, b);
		return;
	}
}

static void
meet_triangles(const Object &o, const Ray &r, Hit &best)
{
	RTCIntersectContext context;
	RTCRayHit rh = {};

	rtcInitIntersectContext(&context);
	rh.ray.org_x = static_cast<float>(r.from[0]);
	rh.ray.org_y = static_cast<float>(r.from[1]);
	rh.ray.org_z = static_cast<float>(r.from[2]);
	rh.ray.dir_x = static_cast<float>(r.dir[0]);
	rh.ray.dir_y = static_cast<float>(r.dir[1]);
	rh.ray.dir_z = static_cast<float>(r.dir[2]);
	rh.ray.tfar = 1e30f;
	rh.ray.mask = ~0u;
	rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	rtcIntersect1(o.scene, &context, &rh);
	if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID ||
	    !(static_cast<double>(rh.ray.tfar) < best.t))
		return;
	const auto &w = o.weights[rh.hit.primID];
	const auto t = static_cast<size_t>(o.triangle[rh.hit.primID]);
	const double x = static_cast<double>(rh.hit.u);
	const double y = static_cast<double>(rh.hit.v);
	Bary b;

	for (size_t i = 0; i < 2; i++)
		b[i] = (1 - x - y) * static_cast<double>(w[0][i]) +
		       x * static_cast<double>(w[1][i]) +
		       y * static_cast<double>(w[2][i]);
	const auto uv = uv_of(corners_of(o, t), b);

	best.t = static_cast<double>(rh.ray.tfar);
	best.o = &o;
	best.u = uv[0];
	best.v = uv[1];
	best.ao = 1;
	look_up(best, t, b);
	best.per_depth = 1 / o.depth;
}

// -- the picture ------------------------------------------------------------

struct Camera {
	int width = 640, height = 480;
	Vec eye{ 0, 0, 4 }, target{ 0, 0, 0 };
	double fov = 40;
	Vec light{ -1, 2, 1.5 };
	double ambient = 0.3, background = 0.02;
};

enum { NCHANNELS = 12 };
static const char *const names[NCHANNELS] = { "R", "G", "B", "A", "Z", "N.x",
	"N.y", "N.z", "AO", "uv.u", "uv.v", "mask" };

static Ray
ray_of(const Camera &c, int x, int y)
{
	const Vec z = unit(c.eye - c.target), up = { 0, 1, 0 };
	const Vec right = unit(cross(up, z)), top = cross(z, right);
	const double half = std::tan(c.fov * std::acos(-1.0) / 360);
	const double sx = half * (2 * x + 1 - c.width) / c.height;
	const double sy = half * (c.height - 2 * y - 1) / c.height;

	return { c.eye, unit(sx * right + sy * top - z) };
}

static Hit
trace(const std::vector<std::unique_ptr<Object>> &objects, const Ray &r)
{
	Hit best;

	for (const auto &o : objects)
		if (o->flat)
			meet_plane(*o, r, best);
		else
			meet_triangles(*o, r, best);
	return best;
}

static void
put(const Camera &c, const Hit &h, float *out)
{
	const Vec light = unit(c.light);

	std::fill(out, out + NCHANNELS, 0.0f);
	for (size_t k = 0; k < 3; k++)
		out[k] = static_cast<float>(c.background);
	out[3] = 1;
	out[4] = std::numeric_limits<float>::infinity();
	if (h.o == nullptr)
		return;
	const double lit = std::max(0.0, dot(h.n, light));

	for (size_t k = 0; k < 3; k++) {
		out[k] =
		    static_cast<float>(h.o->base[k] * (c.ambient * h.ao + lit));
		out[5 + k] = static_cast<float>(h.n[k]);
	}
	out[4] = static_cast<float>(h.t);
	out[8] = static_cast<float>(h.ao);
	out[9] = static_cast<float>(h.u);
	out[10] = static_cast<float>(h.v);
	out[11] = 1;
}

static void
write(const std::string &path, const std::vector<float> &data, const Camera &c)
{
	bake_write_params p = {};
	bake_image img = { c.width, c.height, NCHANNELS,
		static_cast<size_t>(NCHANNELS * c.width),
		const_cast<float *>(data.data()) };
	bake_err err = BAKE_ERR_INIT;
	std::FILE *f = std::fopen(path.c_str(), "wb");

	p.type = BAKE_FILE_EXR;
	p.data_format = BAKE_DATA_FLOAT;
	p.names = names;
	if (f == nullptr ||
	    bake_image_write(&img, &p, f, path.c_str(), nullptr, &err) !=
		BAKE_OK ||
	    std::fclose(f) != 0)
		die(path + ": " + err.msg);
}

// -- comparing --------------------------------------------------------------

static double
encoded(double linear)
{
	const double x = std::min(1.0, std::max(0.0, linear));

	return x <= 0.0031308 ? 12.92 * x
			      : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

// Depth errors are in the relief's range. A pixel is wrong, on another feature,
// where its is above 1/100; the RMS is that of the others.
static void
compare(const std::string &path, const std::vector<float> &truth,
    const std::vector<float> &per_depth, const Camera &c)
{
	const Picture other(path);
	const size_t n = per_depth.size();
	const int z = other.channel("Z"), mask = other.channel("mask");
	const int rgb[3] = { other.channel("R"), other.channel("G"),
		other.channel("B") };
	size_t both = 0, either = 0, wrong = 0;
	double square = 0, depth2 = 0, all2 = 0;

	if (other.img.width != c.width || other.img.height != c.height)
		die(path + " is of another size");
	for (size_t i = 0; i < n; i++) {
		const float *a = &truth[i * NCHANNELS];
		const float *b =
		    other.img.data + i * static_cast<size_t>(other.img.nchans);
		const bool ha = a[11] > 0.5f, hb = b[mask] > 0.5f;

		either += ha || hb;
		if (!ha || !hb)
			continue;
		both++;
		const double e = std::fabs(static_cast<double>(a[4]) -
					   static_cast<double>(b[z])) *
				 static_cast<double>(per_depth[i]);

		all2 += e * e;
		if (e > 0.01)
			wrong++;
		else
			depth2 += e * e;
		for (int k = 0; k < 3; k++) {
			const double d =
			    encoded(static_cast<double>(a[k])) -
			    encoded(static_cast<double>(b[rgb[k]]));

			square += d * d;
		}
	}
	const double hits = static_cast<double>(std::max<size_t>(both, 1));
	const double right =
	    static_cast<double>(std::max<size_t>(both - wrong, 1));

	std::printf("%s\tIoU %.5f\tdepth RMS %.2e (all %.2e)\twrong %.4f %%\t"
		    "PSNR %.2f dB\n",
	    path.c_str(),
	    either ? static_cast<double>(both) / static_cast<double>(either)
		   : 1.0,
	    std::sqrt(depth2 / right), std::sqrt(all2 / hits),
	    100.0 * static_cast<double>(wrong) / hits,
	    -10 * std::log10(square / (3 * hits)));
}

// -- options ----------------------------------------------------------------

static std::vector<double>
numbers(const std::string &text)
{
	std::vector<double> v;
	const char *p = text.c_str();

	while (*p != '\0') {
		char *end;

		v.push_back(std::strtod(p, &end));
		if (end == p)
			die("no numbers: " + text);
		p = end + (*end != '\0');
	}
	return v;
}

static Vec
triple(const std::string &text)
{
	const auto v = numbers(text);

	if (v.size() != 3)
		die("three numbers expected: " + text);
	return { v[0], v[1], v[2] };
}

int
main(int argc, char **argv)
{
	std::vector<std::unique_ptr<Object>> objects;
	std::vector<std::string> against;
	std::string out;
	Camera camera;
	int detail = 16, split = 1;

	for (int i = 1; i + 1 < argc; i += 2) {
		const std::string name = argv[i], value = argv[i + 1];

		if (objects.empty() ||
		    (name == "--shape" && !objects.back()->shape.empty()))
			objects.push_back(std::make_unique<Object>());
		Object &o = *objects.back();

		if (name == "--shape")
			o.shape = value;
		else if (name == "--relief")
			o.relief = std::make_unique<Picture>(value);
		else if (name == "--depth")
			o.depth = numbers(value).at(0);
		else if (name == "--repeat")
			o.repeat = numbers(value).at(0);
		else if (name == "--scale")
			o.scale = numbers(value).at(0);
		else if (name == "--rotate")
			o.rotate = triple(value);
		else if (name == "--translate")
			o.translate = triple(value);
		else if (name == "--base-color")
			o.base = triple(value);
		else if (name == "--detail")
			detail = std::atoi(value.c_str());
		else if (name == "--split")
			split = std::atoi(value.c_str());
		else if (name == "--fov")
			camera.fov = numbers(value).at(0);
		else if (name == "--light")
			camera.light = triple(value);
		else if (name == "--ambient")
			camera.ambient = numbers(value).at(0);
		else if (name == "--camera") {
			const auto v = numbers(value);

			camera.eye = { v.at(0), v.at(1), v.at(2) };
			camera.target = { v.at(3), v.at(4), v.at(5) };
		} else if (name == "--size") {
			const auto v = numbers(value);

			camera.width = static_cast<int>(v.at(0));
			camera.height = static_cast<int>(v.at(1));
		} else if (name == "--against")
			against.push_back(value);
		else if (name == "-o")
			out = value;
		else
			die("no such option: " + name);
	}
	RTCDevice device = rtcNewDevice(nullptr);

	for (auto &o : objects) {
		if (o->shape.empty())
			o->shape = "plane";
		load_mesh(*o, detail);
		if (o->flat)
			build_patches(device, *o);
		else
			build_triangles(device, *o, split);
	}
	std::vector<float> data(static_cast<size_t>(camera.width) *
				static_cast<size_t>(camera.height) * NCHANNELS);
	std::vector<float> per_depth(data.size() / NCHANNELS);

#pragma omp parallel for schedule(dynamic)
	for (int y = 0; y < camera.height; y++)
		for (int x = 0; x < camera.width; x++) {
			const size_t i = static_cast<size_t>(y) *
					     static_cast<size_t>(camera.width) +
					 static_cast<size_t>(x);
			const Hit h = trace(objects, ray_of(camera, x, y));

			put(camera, h, &data[i * NCHANNELS]);
			per_depth[i] = static_cast<float>(h.per_depth);
		}
	if (!out.empty())
		write(out, data, camera);
	for (const auto &path : against)
		compare(path, data, per_depth, camera);
	for (auto &o : objects) {
		rtcReleaseScene(o->scene);
		bake_frames_free(&o->frames);
		bake_mesh_free(&o->mesh);
	}
	rtcReleaseDevice(device);
	return 0;
}
