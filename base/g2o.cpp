// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/pose_graph.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <unordered_map>

namespace adit {
namespace {

// Where the numbers of an edge's information stand in the upper triangle 11 12 13 22 23 33.
constexpr int g2o_order[6] = {0, 1, 2, 3, 4, 5}, toro_order[6] = {0, 1, 3, 5, 2, 4};

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  GraphFile read() {
    std::istringstream in(read_text(file_));
    std::string line;
    for (line_ = 1; std::getline(in, line); ++line_) {
      std::istringstream words(line);
      std::string tag;
      if (words >> tag && tag[0] != '#') take(tag, words);
    }
    if (all_.graph.edge.empty()) throw Error(file_ + ": holds no EDGE_SE2; a pose graph needs at least one edge");
    name_nodes();
    put_first(fixed_ < 0 ? all_.id.front() : fixed_);
    check_joined();
    return std::move(all_);
  }

 private:
  struct Ends {
    int i, j, line;
  };

  [[noreturn]] void fail(const std::string& why) const { throw Error(fmt::format("{}:{}: {}", file_, line_, why)); }

  int integer(std::istringstream& words) const {
    long long n = 0;
    if (!(words >> n) || n < 0 || n > 2000000000) fail("expected the number of a node, 0 or more");
    return static_cast<int>(n);
  }
  double number(std::istringstream& words) const {
    std::string word;
    if (!(words >> word)) fail("a number is missing at the end of the line");
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value)) fail("'" + word + "' is no finite number");
    return value;
  }
  Pose2 pose(std::istringstream& words) const {
    const double x = number(words), y = number(words);
    return {x, y, wrap_angle(number(words))};
  }

  void take(const std::string& tag, std::istringstream& words) {
    if (tag == "VERTEX_SE2" || tag == "VERTEX2") {
      const int id = integer(words);
      add_node(id);
      all_.graph.node.push_back(pose(words));
    } else if (tag == "EDGE_SE2" || tag == "EDGE2") {
      take_edge(words, tag == "EDGE2" ? toro_order : g2o_order);
    } else if (tag == "FIX") {
      if (fixed_ >= 0) fail("a second FIX: one pose is held, the others follow from the edges");
      fixed_ = integer(words);
    } else {
      fail("'" + tag +
           "' is not of a planar pose graph; known are VERTEX_SE2, EDGE_SE2 and FIX (g2o), VERTEX2 and EDGE2 (TORO)");
    }
    if (std::string more; words >> more) fail("'" + more + "' is more than a " + tag + " has");
  }

  void add_node(int id) {
    if (!index_.emplace(id, static_cast<int>(all_.id.size())).second) fail(fmt::format("node {} is given twice", id));
    all_.id.push_back(id);
  }

  void take_edge(std::istringstream& words, const int (&order)[6]) {
    const int i = integer(words), j = integer(words);
    if (i == j) fail(fmt::format("the edge joins node {} to itself", i));
    Relative edge;
    edge.X_ij = pose(words);
    double upper[6];
    for (int k = 0; k < 6; ++k) upper[order[k]] = number(words);
    edge.information << upper[0], upper[1], upper[2], upper[1], upper[3], upper[4], upper[2], upper[4], upper[5];
    if (Eigen::LLT<Eigen::Matrix3d>(edge.information).info() != Eigen::Success)
      fail("the information of the edge is not positive definite");
    all_.graph.edge.push_back(edge);
    ends_.push_back({i, j, line_});
  }

  // Edges name nodes by the file's numbers; from here on by their index.
  void name_nodes() {
    all_.has_poses = !all_.id.empty();
    if (!all_.has_poses) {
      std::vector<int> ids;
      for (const Ends& e : ends_) ids.insert(ids.end(), {e.i, e.j});
      std::sort(ids.begin(), ids.end());
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      for (const int id : ids) add_node(id);
      all_.graph.node.assign(ids.size(), {});
    }
    for (size_t k = 0; k < ends_.size(); ++k) {
      line_ = ends_[k].line;
      all_.graph.edge[k].i = index_of(ends_[k].i);
      all_.graph.edge[k].j = index_of(ends_[k].j);
    }
  }
  int index_of(int id) const {
    const auto found = index_.find(id);
    if (found == index_.end()) fail(fmt::format("the edge names node {}, which has no VERTEX_SE2", id));
    return found->second;
  }

  void put_first(int id) {
    const auto found = index_.find(id);
    if (found == index_.end()) throw Error(fmt::format("{}: FIX names node {}, which is not there", file_, id));
    const int k = found->second;
    if (k == 0) return;
    std::swap(all_.id[0], all_.id[k]);
    std::swap(all_.graph.node[0], all_.graph.node[k]);
    for (Relative& e : all_.graph.edge)
      for (int* end : {&e.i, &e.j}) *end = *end == 0 ? k : *end == k ? 0 : *end;
  }

  void check_joined() const {
    std::vector<int> root(all_.id.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int n) {
      while (root[n] != n) n = root[n] = root[root[n]];
      return n;
    };
    for (const Relative& e : all_.graph.edge) root[find(e.i)] = find(e.j);
    for (size_t n = 1; n < root.size(); ++n)
      if (find(static_cast<int>(n)) != find(0))
        throw Error(
            fmt::format("{}: the graph falls into parts: no edges lead from node {} to node {}; give each part a "
                        "file of its own, or the edges that are missing",
                        file_, all_.id[0], all_.id[n]));
  }

  std::string file_;
  int line_ = 0, fixed_ = -1;
  GraphFile all_;
  std::vector<Ends> ends_;
  std::unordered_map<int, int> index_;
};

}  // namespace

GraphFile read_g2o(const std::string& file) {
  return Reader(file).read();
}

void write_g2o(const std::string& file, const PoseGraph& graph, const std::vector<int>& id) {
  ADIT_CHECK(id.empty() || id.size() == graph.node.size());
  const auto name = [&](int k) { return id.empty() ? k : id[k]; };
  std::string text;
  for (size_t k = 0; k < graph.node.size(); ++k) {
    const Pose2& X = graph.node[k];
    text += fmt::format("VERTEX_SE2 {} {} {} {}\n", name(static_cast<int>(k)), X.x_m, X.y_m, X.yaw_rad);
  }
  if (!graph.node.empty()) text += fmt::format("FIX {}\n", name(0));
  for (const Relative& e : graph.edge) {
    const auto& I = e.information;
    text += fmt::format("EDGE_SE2 {} {} {} {} {} {} {} {} {} {} {}\n", name(e.i), name(e.j), e.X_ij.x_m, e.X_ij.y_m,
                        e.X_ij.yaw_rad, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2));
  }
  write_text(file, text);
}

}  // namespace adit
