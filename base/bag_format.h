// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

// The bag format 2.0 of ROS 1 itself: records, chunks, connections, index. What messages mean is base/bag.h's matter.

/// Nanoseconds since the epoch.
using BagTime = std::uint64_t;

/// A topic of one type.
struct BagConnection {
  std::string topic, type, md5, definition;
  bool latched = false;  // told again to whoever comes later
};

/// Writes a bag in chunks of some 768 KiB, with its index. Times may come in any order, best a growing one.
class BagWriter {
 public:
  explicit BagWriter(std::ostream& out);
  /// @return the number by which messages are written
  std::uint32_t connect(const BagConnection& connection);
  void write(std::uint32_t connection, BagTime time, std::string_view message);
  void close();

 private:
  struct Entry {
    BagTime time;
    std::uint32_t offset;
  };
  struct ChunkInfo {
    std::uint64_t at;
    BagTime first, last;
    std::map<std::uint32_t, std::uint32_t> counts;  // by connection
  };
  void flush();
  void head(std::uint64_t index_at);

  std::ostream& out_;
  std::uint64_t at_ = 0;  // bytes written
  std::vector<BagConnection> connections_;
  std::vector<bool> told_;  // in the file already
  std::string chunk_;
  std::map<std::uint32_t, std::vector<Entry>> index_;  // of the chunk
  std::vector<ChunkInfo> chunks_;
};

/// Goes through a bag's messages in the order of the file, by its records and not its index.
/// @param take  is given each message with its connection
/// @return      empty, or where and why the file ends before its end
/// @throws Error where it is not a bag of version 2.0 or its chunks are packed in an unknown way
std::string scan_bag(const std::string& file,
                     const std::function<void(const BagConnection&, BagTime, std::string_view)>& take);

}  // namespace adit
