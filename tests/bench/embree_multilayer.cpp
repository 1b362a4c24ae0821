// Times Embree on bench_multilayer's work: all crossings of one ray a texel.
// SPDX-License-Identifier: MIT
//
//	c++ -O3 -std=c++17 tests/bench/embree_multilayer.cpp -lembree3
//	bench_multilayer --write weave weave.obj
//	a.out weave.obj 4096 0 0 8 8 0.6
//
// Arguments: mesh, side of the picture, its region x0 y0 x1 y1, and a z above
// all. Not built by make, as Embree is needed for this comparison alone;
// scripts/bench builds and runs it where it is installed. Single rays, whose
// hits a filter keeps and lets pass, which is the fastest way to all of them;
// robust intersections; one thread. Sorting is in the time, as it is in
// bench_multilayer's; building the tree is not.
#include <embree3/rtcore.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

struct Hit {
	float depth;
	unsigned triangle;
	bool entering;
};

// The context must come first: Embree hands back a pointer to it.
struct Context {
	RTCIntersectContext embree;
	std::vector<Hit> hits;
};

static void
keep(const RTCFilterFunctionNArguments *args)
{
	auto *context = reinterpret_cast<Context *>(args->context);
	const auto *ray = reinterpret_cast<const RTCRay *>(args->ray);
	const auto *hit = reinterpret_cast<const RTCHit *>(args->hit);

	// the same triangle may be offered twice, from two leaves
	context->hits.push_back({ ray->tfar, hit->primID, hit->Ng_z > 0 });
	args->valid[0] = 0;
}

static double
seconds()
{
	timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return static_cast<double>(t.tv_sec) +
	       1e-9 * static_cast<double>(t.tv_nsec);
}

static RTCScene
read_obj(RTCDevice device, const char *path)
{
	std::vector<float> p;
	std::vector<unsigned> t;
	std::FILE *f = std::fopen(path, "r");
	RTCGeometry geometry =
	    rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
	RTCScene scene = rtcNewScene(device);
	char line[256];
	float x[3];
	unsigned v[3];

	if (f == nullptr) {
		std::perror(path);
		std::exit(1);
	}
	while (std::fgets(line, sizeof line, f) != nullptr)
		if (std::sscanf(line, "v %f %f %f", x, x + 1, x + 2) == 3)
			p.insert(p.end(), x, x + 3);
		else if (std::sscanf(line, "f %u %u %u", v, v + 1, v + 2) == 3)
			for (unsigned i : v)
				t.push_back(i - 1);
	std::fclose(f);
	std::copy(p.begin(), p.end(),
	    static_cast<float *>(
		rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
		    RTC_FORMAT_FLOAT3, 12, p.size() / 3)));
	std::copy(t.begin(), t.end(),
	    static_cast<unsigned *>(rtcSetNewGeometryBuffer(geometry,
		RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, t.size() / 3)));
	rtcSetGeometryIntersectFilterFunction(geometry, keep);
	rtcCommitGeometry(geometry);
	rtcAttachGeometry(scene, geometry);
	rtcReleaseGeometry(geometry);
	rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
	rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
	rtcCommitScene(scene);
	return scene;
}

int
main(int argc, char **argv)
{
	if (argc != 8) {
		std::fprintf(stderr,
		    "usage: embree_multilayer OBJ SIDE X0 Y0 X1 Y1 ZTOP\n");
		return 2;
	}
	const int side = std::atoi(argv[2]);
	double at[5];
	for (int i = 0; i < 5; i++)
		at[i] = std::atof(argv[3 + i]);
	RTCDevice device = rtcNewDevice("threads=1");
	double start = seconds();
	RTCScene scene = read_obj(device, argv[1]);
	double ready = seconds();
	std::vector<Hit> all;
	std::vector<double> times;
	size_t odd = 0, total = 0;

	for (int run = 0; run < 3; run++) {
		double begin = seconds();

		odd = total = 0;
		for (int y = 0; y < side; y++) {
			// a row's worth is kept, as ours keeps a band
			all.clear();
			for (int x = 0; x < side; x++) {
				Context c;
				RTCRayHit r = {};

				rtcInitIntersectContext(&c.embree);
				c.hits.swap(all);
				size_t n = c.hits.size();
				r.ray.org_x = static_cast<float>(
				    at[0] + (x + 0.5) * (at[2] - at[0]) / side);
				r.ray.org_y = static_cast<float>(
				    at[3] - (y + 0.5) * (at[3] - at[1]) / side);
				r.ray.org_z = static_cast<float>(at[4]);
				r.ray.dir_z = -1;
				r.ray.tfar = 1e30f;
				r.ray.mask = ~0u;
				r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
				rtcIntersect1(scene, &c.embree, &r);
				all.swap(c.hits);
				std::sort(all.begin() + static_cast<long>(n),
				    all.end(), [](const Hit &a, const Hit &b) {
					    return a.depth < b.depth;
				    });
				odd += (all.size() - n) % 2;
			}
			total += all.size();
		}
		times.push_back(seconds() - begin);
	}
	std::sort(times.begin(), times.end());
	std::printf("Embree %d.%d, reading and tree, s\t%.3f\n",
	    RTC_VERSION_MAJOR, RTC_VERSION_MINOR, ready - start);
	std::printf("Embree %d.%d, single rays at %dx%d, s\t%.3f\t%.3f\n",
	    RTC_VERSION_MAJOR, RTC_VERSION_MINOR, side, side, times[0],
	    times[1]);
	std::printf("  %zu crossings, %zu texels odd\n", total, odd);
	rtcReleaseScene(scene);
	rtcReleaseDevice(device);
	return 0;
}
