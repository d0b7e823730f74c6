// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/pose_graph.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace adit {
namespace {

using testing::HasSubstr;

std::string written(const std::string& text) {
  const std::string file = scratch("graph.g2o");
  write_text(file, text);
  return file;
}

std::string complaint(const std::string& text) {
  try {
    read_g2o(written(text));
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

const std::string two = "VERTEX_SE2 7 0 0 0\nVERTEX_SE2 9 1 0 0\n";
const std::string edge = "EDGE_SE2 7 9 1 0 0 1 0 0 1 0 1\n";

TEST(G2o, WhatIsWrittenIsReadBackToTheBit) {
  PoseGraph graph;
  graph.node = {{0, 0, 0}, {1.0 / 3, -2e-17, 3}, {1e9, 0.1, -1}};
  Relative e{0, 1, {0.1, 0.2, 0.3}, Eigen::Matrix3d::Identity()};
  e.information << 3, 0.1, 0.2, 0.1, 4, 0.3, 0.2, 0.3, 1.0 / 7;
  graph.edge = {e, {2, 1, {1, 2, -3}, 2 * Eigen::Matrix3d::Identity()}};
  const std::string file = scratch("graph.g2o");
  write_g2o(file, graph, {5, 3, 8});
  const GraphFile back = read_g2o(file);
  EXPECT_EQ(back.id, (std::vector<int>{5, 3, 8}));
  EXPECT_TRUE(back.has_poses);
  ASSERT_EQ(back.graph.edge.size(), 2u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(back.graph.node[k].x_m, graph.node[k].x_m);
    EXPECT_EQ(back.graph.node[k].yaw_rad, graph.node[k].yaw_rad);
  }
  EXPECT_EQ(back.graph.edge[0].information, e.information);
  EXPECT_EQ(back.graph.edge[1].i, 2);
  EXPECT_EQ(back.graph.edge[1].j, 1);
}

TEST(G2o, TheFixedNodeComesFirstAndEdgesFollow) {
  const GraphFile g = read_g2o(written(two + "FIX 9\n" + edge));
  EXPECT_EQ(g.id, (std::vector<int>{9, 7}));
  EXPECT_EQ(g.graph.node[0].x_m, 1);
  EXPECT_EQ(g.graph.edge[0].i, 1);
  EXPECT_EQ(g.graph.edge[0].j, 0);
}

TEST(G2o, EdgesAloneMakeAGraph) {
  const GraphFile g = read_g2o(written("# edges\n" + edge));
  EXPECT_FALSE(g.has_poses);
  EXPECT_EQ(g.id, (std::vector<int>{7, 9}));
}

TEST(G2o, TorosOrderOfTheInformationIsItsOwn) {
  const GraphFile g = read_g2o(written("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 0 0 11 1 22 33 2 3\n"));
  Eigen::Matrix3d expected;
  expected << 11, 1, 2, 1, 22, 3, 2, 3, 33;
  EXPECT_EQ(g.graph.edge[0].information, expected);
}

TEST(G2o, BadInputIsNamedWithItsLine) {
  EXPECT_THAT(complaint(two + "EDGE_SE2 7 9 1 0 0 1 0 0 1 0\n"), HasSubstr(":3: a number is missing"));
  EXPECT_THAT(complaint(two + "EDGE_SE2 7 9 1 0 nan 1 0 0 1 0 1\n"), HasSubstr(":3: 'nan' is no finite number"));
  EXPECT_THAT(complaint(two + "EDGE_SE2 7 9 1 0 0 1 0 0 -1 0 1\n"), HasSubstr("not positive definite"));
  EXPECT_THAT(complaint(two + "EDGE_SE2 7 7 1 0 0 1 0 0 1 0 1\n"), HasSubstr("node 7 to itself"));
  EXPECT_THAT(complaint(two + edge + "EDGE_SE2 9 11 1 0 0 1 0 0 1 0 1\n"), HasSubstr(":4: the edge names node 11"));
  EXPECT_THAT(complaint(two + two + edge), HasSubstr(":3: node 7 is given twice"));
  EXPECT_THAT(complaint("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"), HasSubstr("not of a planar pose graph"));
  EXPECT_THAT(complaint(two + edge + "FIX 3\n"), HasSubstr("FIX names node 3"));
  EXPECT_THAT(complaint(two + edge + "VERTEX_SE2 1 0 0 0\n"), HasSubstr("no edges lead from node 7 to node 1"));
  EXPECT_THAT(complaint(two), HasSubstr("holds no EDGE_SE2"));
}

}  // namespace
}  // namespace adit
