// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/medial_dump.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace spheretree::io {
namespace {

TEST(MedialDump, IsAPointCloudWithRadiiAndEdges) {
  medial::MedialAxis axis;
  axis.balls.push_back({{{1, 2, 3}, 0.5}, 0.25});
  axis.balls.push_back({{{1.0 / 3, -1e-7, 12345.678}, 2.0 / 3}, 0.1});
  axis.neighbours.push_back({0, 1});
  std::istringstream text(formatMedialAxis(axis));
  std::string line;
  std::string header;
  while (std::getline(text, line) && line != "end_header") header += line + "\n";
  EXPECT_EQ(header.rfind("ply\nformat ascii 1.0\n", 0), 0U);
  EXPECT_NE(header.find("element vertex 2\n"), std::string::npos);
  EXPECT_NE(header.find("element edge 1\n"), std::string::npos);
  for (const medial::MedialBall& ball : axis.balls) {
    double x = 0;
    double y = 0;
    double z = 0;
    double radius = 0;
    double depth = 0;
    ASSERT_TRUE(text >> x >> y >> z >> radius >> depth);
    EXPECT_EQ(Eigen::Vector3d(x, y, z), ball.ball.center) << "bit for bit";
    EXPECT_EQ(radius, ball.ball.radius);
    EXPECT_EQ(depth, ball.depth);
  }
  std::uint32_t a = 9;
  std::uint32_t b = 9;
  ASSERT_TRUE(text >> a >> b);
  EXPECT_EQ(a, 0U);
  EXPECT_EQ(b, 1U);
  EXPECT_FALSE(text >> line) << "nothing follows";
}

TEST(MedialDump, OfNothingIsAHeader) {
  const std::string text = formatMedialAxis({});
  EXPECT_NE(text.find("element vertex 0\n"), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 11), "end_header\n");
}

}  // namespace
}  // namespace spheretree::io
