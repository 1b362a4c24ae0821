// Times CGAL's jet fitting (degree 2) on the torus of bench_quadfit, 2 rings.
// SPDX-License-Identifier: MIT
//
//	c++ -O3 -I/usr/include/eigen3 tests/bench/cgal_quadfit.cpp -o
// cgal_quadfit
//	./cgal_quadfit 316
//
// Not built by make: CGAL and Eigen are needed for this comparison alone. The
// neighbours are found beforehand, and are not in the time.
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <set>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Fitting = CGAL::Monge_via_jet_fitting<Kernel>;

static unsigned
hash(unsigned z)
{
	z = (z ^ z >> 16) * 0x85ebca6bu;
	z = (z ^ z >> 13) * 0xc2b2ae35u;
	return z ^ z >> 16;
}

static double
seconds()
{
	timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return static_cast<double>(t.tv_sec) +
	       1e-9 * static_cast<double>(t.tv_nsec);
}

int
main(int argc, char **argv)
{
	const int n = argc > 1 ? std::atoi(argv[1]) : 316;
	const double turn = 6.283185307179586 / n;
	std::vector<Kernel::Point_3> p;
	std::vector<std::vector<Kernel::Point_3>> around;

	for (int v = 0; v < n * n; v++) {
		double du =
		    hash(static_cast<unsigned>(v)) / 8589934592.0 - 0.25;
		double dv =
		    hash(~static_cast<unsigned>(v)) / 8589934592.0 - 0.25;
		double a = turn * (v / n + du), b = turn * (v % n + dv);

		p.emplace_back((1 + 0.35 * std::cos(b)) * std::cos(a),
		    (1 + 0.35 * std::cos(b)) * std::sin(a), 0.35 * std::sin(b));
	}
	for (int v = 0; v < n * n; v++) {
		static const int step[6][2] = { { 1, 0 }, { 1, 1 }, { 0, 1 },
			{ -1, 0 }, { -1, -1 }, { 0, -1 } };
		std::set<int> ring;

		for (auto &s : step)
			for (auto &t : step)
				for (int k = 0; k < 2; k++)
					ring.insert(
					    (v / n + s[0] + k * t[0] + 2 * n) %
						n * n +
					    (v + s[1] + k * t[1] + 2 * n) % n);
		around.emplace_back(1, p[v]);
		for (int w : ring)
			if (w != v)
				around.back().push_back(p[w]);
	}
	double best = 1e30, sum = 0;
	for (int run = 0; run < 3; run++) {
		double start = seconds();

		for (auto &points : around) {
			Fitting fitting;
			auto form = fitting(points.begin(), points.end(), 2, 2);

			sum += form.principal_curvatures(0);
		}
		best = std::fmin(best, seconds() - start);
	}
	std::printf("CGAL jet fitting, %d vertices, ns a vertex\t%.0f\t(%g)\n",
	    n * n, best / (n * n) * 1e9, sum);
	return 0;
}
