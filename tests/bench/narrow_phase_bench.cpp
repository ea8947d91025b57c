// SPDX-License-Identifier: GPL-3.0-or-later
//
// narrow_phase_bench TREE.sph MESH.obj [POSES]: what one pair query costs, and what it is worth.
//
// The solid against itself in random close poses: the boxes of both bodies overlap. Without rotation, and
// with both bodies turned at random. Warm: all poses use one tree, after a pass that is not measured. Cold:
// every pose has its own two copies of the tree, more memory than caches hold. Where FCL is present, its test
// of mesh against mesh runs on the same poses in the same process and says which hits are true. Times are the
// best of several passes over all poses; each row carries a hash of its answers.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <spheretree/pair_query.hpp>
#include <spheretree/simd.hpp>
#include <spheretree/sph.hpp>

#ifdef SPHERETREE_HAVE_FCL
#include <fcl/fcl.h>
#endif

namespace {

using namespace spheretree;

constexpr std::uint32_t kSeed = 1;
constexpr std::size_t kDefaultPoses = 4000;
constexpr int kPasses = 15;
constexpr int kSlowPasses = 2;  // of tests that take a hundred times as long

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

struct PosePair {
  Pose a;
  Pose b;
};

enum class Turning : std::uint8_t { None, Both };

/// The vertices and faces of an OBJ file; polygons as fans.
Mesh readObj(const char* path) {
  Mesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.points.push_back(p);
    } else if (word == "f") {
      std::vector<std::size_t> corners;
      while (words >> word) corners.push_back(std::strtoul(word.c_str(), nullptr, 10) - 1);
      for (std::size_t k = 2; k < corners.size(); ++k)
        mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  return mesh;
}

std::string readText(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Aabb boundsOf(const Mesh& mesh, const Pose& pose) {
  Aabb box{transform(pose, mesh.points[0]), transform(pose, mesh.points[0])};
  for (const Vec3 point : mesh.points) {
    const Vec3 p = transform(pose, point);
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
  }
  return box;
}

class Random {
 public:
  float uniform(float low, float high) {
    return low + (high - low) * (static_cast<float>(engine_() >> 8U) * 0x1p-24F);
  }
  /// Uniform over all rotations (K. Shoemake, Uniform random rotations, Graphics Gems III, 1992).
  Rotation rotation() {
    constexpr float kTurn = 2 * std::numbers::pi_v<float>;
    const float u = uniform(0, 1);
    const float v = uniform(0, kTurn);
    const float w = uniform(0, kTurn);
    const float r = std::sqrt(1 - u);
    const float s = std::sqrt(u);
    return {r * std::sin(v), r * std::cos(v), s * std::sin(w), s * std::cos(w)};
  }

 private:
  std::mt19937 engine_{kSeed};
};

std::vector<PosePair> makePoses(const Mesh& mesh, Turning turning, std::size_t count) {
  Random random;
  std::vector<PosePair> poses;
  while (poses.size() < count) {
    PosePair pair;
    if (turning == Turning::Both) pair = {{random.rotation(), {}}, {random.rotation(), {}}};
    const Aabb a = boundsOf(mesh, pair.a);
    const Aabb b = boundsOf(mesh, pair.b);
    // A may move between the places where the boxes just touch.
    pair.a.translation = {random.uniform(b.min.x - a.max.x, b.max.x - a.min.x),
                          random.uniform(b.min.y - a.max.y, b.max.y - a.min.y),
                          random.uniform(b.min.z - a.max.z, b.max.z - a.min.z)};
    poses.push_back(pair);
  }
  return poses;
}

struct Sample {
  double microseconds = 0;  // per pair
  std::vector<std::uint8_t> hits;
  double tests = 0;  // per pair
};

std::uint64_t hashOf(const std::vector<std::uint8_t>& hits) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::uint8_t hit : hits) hash = (hash ^ hit) * 0x100000001b3U;
  return hash;
}

/// `query(i)` for every pose, several times; the best time.
template <class Query>
Sample measure(std::size_t count, int passes, Query query) {
  Sample sample;
  sample.hits.resize(count);
  for (int pass = 0; pass <= passes; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < count; ++i) sample.hits[i] = query(i) ? 1 : 0;
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
    const double each = spent.count() / static_cast<double>(count);
    if (pass == 1 || (pass > 0 && each < sample.microseconds)) sample.microseconds = each;
  }
  return sample;
}

struct Share {
  double hits = 0;
  double misses = 0;
};

/// Mean times over the poses that hit and those that miss, each group measured by itself.
template <class Query>
Share measureShares(const Sample& truth, Query query) {
  Share share;
  for (const std::uint8_t wanted : {std::uint8_t{0}, std::uint8_t{1}}) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < truth.hits.size(); ++i)
      if (truth.hits[i] == wanted) chosen.push_back(i);
    if (chosen.empty()) continue;
    const Sample sample = measure(chosen.size(), kPasses, [&](std::size_t i) { return query(chosen[i]); });
    (wanted == 1 ? share.hits : share.misses) = sample.microseconds;
  }
  return share;
}

void printRow(const char* turning, const char* test, const char* caches, int level, const Sample& sample,
              const Share& share, const Sample& truth) {
  std::size_t hits = 0;
  std::size_t falseHits = 0;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < sample.hits.size(); ++i) {
    hits += sample.hits[i];
    if (truth.hits.empty()) continue;
    falseHits += sample.hits[i] > truth.hits[i] ? 1U : 0U;
    lost += sample.hits[i] < truth.hits[i] ? 1U : 0U;
  }
  std::printf("%s,%s,%s,%d,%.4f,%.4f,%.4f,%.1f,%zu,%zu,%zu,%016llx\n", turning, test, caches, level,
              sample.microseconds, share.hits, share.misses, sample.tests, hits, falseHits, lost,
              static_cast<unsigned long long>(hashOf(sample.hits)));
}

#ifdef SPHERETREE_HAVE_FCL

fcl::Transform3<double> transformOf(const Pose& pose) {
  const Rotation& q = pose.rotation;
  const auto wide = [](float value) { return static_cast<double>(value); };
  fcl::Transform3<double> t = fcl::Transform3<double>::Identity();
  t.linear() = fcl::Quaternion<double>(wide(q.w), wide(q.x), wide(q.y), wide(q.z)).normalized().matrix();
  t.translation() =
      fcl::Vector3<double>(wide(pose.translation.x), wide(pose.translation.y), wide(pose.translation.z));
  return t;
}

template <class Volume>
Sample fclSample(const Mesh& mesh, const std::vector<PosePair>& poses) {
  fcl::BVHModel<Volume> model;
  model.beginModel();
  const auto point = [&](std::size_t i) {
    const Vec3 p = mesh.points[i];
    return fcl::Vector3<double>(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  };
  for (const auto& t : mesh.triangles) model.addTriangle(point(t[0]), point(t[1]), point(t[2]));
  model.endModel();
  std::vector<fcl::Transform3<double>> a;
  std::vector<fcl::Transform3<double>> b;
  for (const PosePair& pair : poses) {
    a.push_back(transformOf(pair.a));
    b.push_back(transformOf(pair.b));
  }
  const fcl::CollisionRequest<double> request;
  return measure(poses.size(), kSlowPasses, [&](std::size_t i) {
    fcl::CollisionResult<double> result;
    return fcl::collide(&model, a[i], &model, b[i], request, result) > 0;
  });
}

Sample truthOf(const Mesh& mesh, const std::vector<PosePair>& poses, const char* turning) {
  Sample obb = fclSample<fcl::OBB<double>>(mesh, poses);
  printRow(turning, "fcl-obb", "warm", -1, obb, {}, obb);
  const Sample rss = fclSample<fcl::OBBRSS<double>>(mesh, poses);
  printRow(turning, "fcl-obbrss", "warm", -1, rss, {}, obb);
  obb.microseconds = std::min(obb.microseconds, rss.microseconds);
  return obb;
}

#else

Sample truthOf(const Mesh&, const std::vector<PosePair>&, const char*) {
  return {};
}

#endif

double meanTests(const QueryTree& tree, const std::vector<PosePair>& poses, std::uint32_t level) {
  PairQuery query(tree, tree);
  double tests = 0;
  for (const PosePair& pair : poses) {
    query.restart(pair.a, pair.b);
    query.advance({.deepestLevel = level});
    tests += static_cast<double>(query.sphereTests());
  }
  return tests / static_cast<double>(poses.size());
}

const char* nameOf(SimdLevel level) {
  switch (level) {
    case SimdLevel::Scalar:
      return "scalar";
    case SimdLevel::Sse2:
      return "sse2";
    case SimdLevel::Avx2:
      return "avx2";
    case SimdLevel::Avx512:
      return "avx512";
  }
  return "";
}

void benchWarm(const QueryTree& tree, const std::vector<PosePair>& poses, const char* turning,
               const Sample& truth) {
  const SimdLevel best = supportedSimd();
  for (std::uint8_t path = 0; path <= static_cast<std::uint8_t>(best); ++path) {
    const auto simd = static_cast<SimdLevel>(path);
    limitSimd(simd);
    const auto last = static_cast<std::uint32_t>(tree.levelCount() - 1);
    for (std::uint32_t level = simd == best ? 0 : last; level <= last; ++level) {
      PairQuery query(tree, tree);
      const QueryLimits limits{.deepestLevel = level};
      const auto ask = [&](std::size_t i) {
        query.restart(poses[i].a, poses[i].b);
        return query.advance(limits) == Answer::Overlapping;
      };
      Sample sample = measure(poses.size(), kPasses, ask);
      sample.tests = meanTests(tree, poses, level);
      printRow(turning, nameOf(simd), "warm", static_cast<int>(level), sample,
               measureShares(truth.hits.empty() ? sample : truth, ask), truth);
      if (simd == best && level == last && !truth.hits.empty())
        std::printf("# %s: the best FCL mesh test takes %.0f times as long\n", turning,
                    truth.microseconds / sample.microseconds);
    }
  }
}

void benchCold(const QueryTree& tree, const std::vector<PosePair>& poses, const char* turning,
               const Sample& truth) {
  const std::vector<QueryTree> copies(2 * poses.size(), tree);
  PairQuery query;
  Sample sample = measure(poses.size(), kPasses, [&](std::size_t i) {
    query.setTrees(copies[2 * i], copies[2 * i + 1]);
    query.restart(poses[i].a, poses[i].b);
    return query.advance() == Answer::Overlapping;
  });
  printRow(turning, nameOf(activeSimd()), "cold", static_cast<int>(tree.levelCount()) - 1, sample, {}, truth);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: narrow_phase_bench TREE.sph MESH.obj [POSES]\n");
    return 2;
  }
  const Result<SphFile> file = parseSph(readText(argv[1]));
  if (!file) {
    std::fprintf(stderr, "%s: %s\n", argv[1], file.error().message.c_str());
    return 3;
  }
  const Result<QueryTree> tree = QueryTree::create(file->tree, standOffsOf(*file));
  const Mesh mesh = readObj(argv[2]);
  if (!tree || mesh.triangles.empty()) {
    std::fprintf(stderr, "%s: no mesh, or the tree is not usable\n", argv[2]);
    return 3;
  }
  const std::size_t count = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : kDefaultPoses;
  std::printf("# %zu balls, %zu levels, %zu bytes for queries, %zu triangles, %zu poses\n",
              file->tree.nodes().size(), tree.value().levelCount(), tree.value().bytes(),
              mesh.triangles.size(), count);
  std::printf(
      "rotation,test,caches,level,mean_us,true_hit_us,true_miss_us,sphere_tests,hits,false_hits,lost_hits,"
      "hash\n");
  for (const Turning turning : {Turning::None, Turning::Both}) {
    const char* name = turning == Turning::None ? "none" : "both";
    const std::vector<PosePair> poses = makePoses(mesh, turning, count);
    const Sample truth = truthOf(mesh, poses, name);
    benchWarm(tree.value(), poses, name, truth);
    benchCold(tree.value(), poses, name, truth);
  }
  return 0;
}
