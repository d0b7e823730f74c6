// SPDX-License-Identifier: BSD-3-Clause
#include "base/bag_format.h"

#include "base/error.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <ostream>

namespace adit {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
enum Op : std::uint8_t { message = 2, bag_head = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

template <class T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

// A time as seconds and nanoseconds.
std::string bytes_of_time(BagTime t) {
  return bytes_of(static_cast<std::uint32_t>(t / 1000000000)) + bytes_of(static_cast<std::uint32_t>(t % 1000000000));
}

using Header = std::vector<std::pair<std::string, std::string>>;

std::string packed(const Header& fields) {
  std::string text;
  for (const auto& [name, value] : fields)
    text += bytes_of(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
  return text;
}

std::string record(Op op, const Header& fields, std::string_view data) {
  Header all = fields;
  all.emplace_back("op", bytes_of(static_cast<std::uint8_t>(op)));
  const std::string head = packed(all);
  std::string text = bytes_of(static_cast<std::uint32_t>(head.size())) + head;
  text += bytes_of(static_cast<std::uint32_t>(data.size()));
  text += data;
  return text;
}

std::string record_of(const BagConnection& c, std::uint32_t number) {
  Header data{{"topic", c.topic}, {"type", c.type}, {"md5sum", c.md5}, {"message_definition", c.definition}};
  if (c.latched) data.insert(data.end(), {{"callerid", "/adit"}, {"latching", "1"}});
  return record(connection, {{"conn", bytes_of(number)}, {"topic", c.topic}}, packed(data));
}

}  // namespace

BagWriter::BagWriter(std::ostream& out) : out_(out) {
  out_ << magic;
  at_ = magic.size();
  head(0);
}

// A record of 4096 bytes, so that it can be written again when the index is there.
void BagWriter::head(std::uint64_t index_at) {
  constexpr size_t size = 4096;
  const Header fields{{"index_pos", bytes_of(index_at)},
                      {"conn_count", bytes_of(static_cast<std::uint32_t>(connections_.size()))},
                      {"chunk_count", bytes_of(static_cast<std::uint32_t>(chunks_.size()))}};
  const std::string bare = record(bag_head, fields, "");
  out_ << record(bag_head, fields, std::string(size - bare.size(), ' '));
  at_ += size;
}

std::uint32_t BagWriter::connect(const BagConnection& c) {
  connections_.push_back(c);
  told_.push_back(false);
  return static_cast<std::uint32_t>(connections_.size() - 1);
}

void BagWriter::write(std::uint32_t number, BagTime time, std::string_view data) {
  if (!told_[number]) chunk_ += record_of(connections_[number], number);
  told_[number] = true;
  index_[number].push_back({time, static_cast<std::uint32_t>(chunk_.size())});
  chunk_ += record(message, {{"conn", bytes_of(number)}, {"time", bytes_of_time(time)}}, data);
  if (chunk_.size() > (768U << 10)) flush();
}

void BagWriter::flush() {
  if (chunk_.empty()) return;
  ChunkInfo info{at_, std::numeric_limits<BagTime>::max(), 0, {}};
  std::string text =
      record(chunk, {{"compression", "none"}, {"size", bytes_of(static_cast<std::uint32_t>(chunk_.size()))}}, chunk_);
  for (const auto& [number, entries] : index_) {
    std::string data;
    for (const Entry& e : entries) {
      data += bytes_of_time(e.time) + bytes_of(e.offset);
      info.first = std::min(info.first, e.time);
      info.last = std::max(info.last, e.time);
    }
    const auto count = static_cast<std::uint32_t>(entries.size());
    info.counts[number] = count;
    text += record(index, {{"ver", bytes_of(std::uint32_t{1})}, {"conn", bytes_of(number)}, {"count", bytes_of(count)}},
                   data);
  }
  out_ << text;
  at_ += text.size();
  chunks_.push_back(std::move(info));
  chunk_.clear();
  index_.clear();
}

void BagWriter::close() {
  flush();
  const std::uint64_t index_at = at_;
  for (std::uint32_t n = 0; n < connections_.size(); ++n) out_ << record_of(connections_[n], n);
  for (const ChunkInfo& c : chunks_) {
    std::string data;
    for (const auto& [number, count] : c.counts) data += bytes_of(number) + bytes_of(count);
    out_ << record(chunk_info,
                   {{"ver", bytes_of(std::uint32_t{1})},
                    {"chunk_pos", bytes_of(c.at)},
                    {"start_time", bytes_of_time(c.first)},
                    {"end_time", bytes_of_time(c.last)},
                    {"count", bytes_of(static_cast<std::uint32_t>(c.counts.size()))}},
                   data);
  }
  out_.seekp(static_cast<std::streamoff>(magic.size()));
  head(index_at);
}

namespace {

// Thrown where bytes run out; what was read before stands.
struct Cut {};

template <class T>
T value_of(std::string_view bytes) {
  if (bytes.size() < sizeof(T)) throw Cut{};
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::string_view take_block(std::string_view& rest) {
  const size_t size = value_of<std::uint32_t>(rest);
  if (rest.size() - 4 < size) throw Cut{};
  const std::string_view block = rest.substr(4, size);
  rest.remove_prefix(4 + size);
  return block;
}

std::map<std::string, std::string_view> fields_of(std::string_view head) {
  std::map<std::string, std::string_view> fields;
  while (!head.empty()) {
    const std::string_view field = take_block(head);
    const size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw Cut{};
    fields[std::string(field.substr(0, equals))] = field.substr(equals + 1);
  }
  return fields;
}

// As much as there is of it.
std::string unpacked_bz2(std::string_view data, size_t size) {
  std::string out(size, '\0');
  bz_stream s{};
  if (BZ2_bzDecompressInit(&s, 0, 0) != BZ_OK) throw Error("bz2 cannot start", Fault::bug);
  s.next_in = const_cast<char*>(data.data());
  s.avail_in = static_cast<unsigned>(data.size());
  s.next_out = out.data();
  s.avail_out = static_cast<unsigned>(size);
  while (s.avail_out > 0 && BZ2_bzDecompress(&s) == BZ_OK && s.avail_in > 0) {
  }
  out.resize(size - s.avail_out);
  BZ2_bzDecompressEnd(&s);
  return out;
}

std::string unpacked_lz4(std::string_view data, size_t size) {
  std::string out(size, '\0');
  LZ4F_decompressionContext_t s = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&s, LZ4F_VERSION))) throw Error("lz4 cannot start", Fault::bug);
  size_t from = 0, to = 0;
  while (from < data.size() && to < size) {
    size_t read = data.size() - from, written = size - to;
    if (LZ4F_isError(LZ4F_decompress(s, out.data() + to, &written, data.data() + from, &read, nullptr))) break;
    from += read, to += written;
    if (read == 0 && written == 0) break;
  }
  LZ4F_freeDecompressionContext(s);
  out.resize(to);
  return out;
}

class BagScan {
 public:
  BagScan(std::string file, const std::function<void(const BagConnection&, BagTime, std::string_view)>& take)
      : name_(std::move(file)), in_(name_, std::ios::binary), take_(take) {
    std::error_code failed;
    size_ = std::filesystem::file_size(name_, failed);
    if (!in_ || failed) throw Error(name_ + ": no such file, or it cannot be read");
    std::string first(magic.size(), '\0');
    in_.read(first.data(), static_cast<std::streamsize>(first.size()));
    if (first == magic) return;
    if (first.starts_with("#ROSBAG V1"))
      throw Error(name_ + ": is a bag of version 1; 'rosbag fix' makes one of version 2.0");
    throw Error(name_ + ": is not a ROS 1 bag");
  }

  std::string run() {
    while (static_cast<std::uint64_t>(in_.tellg()) < size_) {
      const auto at = static_cast<std::uint64_t>(in_.tellg());
      try {
        const std::string head = block();
        const auto fields = fields_of(head);
        const auto op = value_of<std::uint8_t>(field(fields, "op"));
        if (op == chunk) {
          unpack(fields);
        } else {
          const std::string data = block();
          if (op == connection || op == message) record(op, fields, data);
        }
      } catch (const Cut&) {
        return "is cut off or damaged after byte " + std::to_string(at) + " of " + std::to_string(size_) +
               "; what stands before is read";
      }
    }
    return "";
  }

 private:
  std::string block() {
    std::string size(4, '\0');
    if (!in_.read(size.data(), 4)) throw Cut{};
    return bytes(value_of<std::uint32_t>(size));
  }

  std::string bytes(std::uint64_t n) {
    const auto at = static_cast<std::uint64_t>(in_.tellg());
    if (n > size_ - at) throw Cut{};
    std::string data(n, '\0');
    in_.read(data.data(), static_cast<std::streamsize>(n));
    return data;
  }

  static std::string_view field(const std::map<std::string, std::string_view>& fields, const std::string& name) {
    const auto found = fields.find(name);
    if (found == fields.end()) throw Cut{};
    return found->second;
  }

  void unpack(const std::map<std::string, std::string_view>& fields) {
    const std::string packing(field(fields, "compression"));
    const size_t whole = value_of<std::uint32_t>(field(fields, "size"));
    if (whole > size_t{1} << 30) throw Cut{};  // of which nobody makes chunks
    std::string size(4, '\0');
    if (!in_.read(size.data(), 4)) throw Cut{};
    const std::uint64_t said = value_of<std::uint32_t>(size), left = size_ - static_cast<std::uint64_t>(in_.tellg());
    std::string data = bytes(std::min(said, left));
    if (packing == "bz2")
      data = unpacked_bz2(data, whole);
    else if (packing == "lz4")
      data = unpacked_lz4(data, whole);
    else if (packing != "none")
      throw Error(name_ + ": has a chunk packed as '" + packing + "'; none, bz2 and lz4 are known");
    for (std::string_view rest = data; !rest.empty();) {
      const auto inner = fields_of(take_block(rest));
      const std::string_view content = take_block(rest);
      record(value_of<std::uint8_t>(field(inner, "op")), inner, content);
    }
    if (said > left || data.size() != whole) throw Cut{};
  }

  void record(std::uint8_t op, const std::map<std::string, std::string_view>& fields, std::string_view data) {
    const auto number = value_of<std::uint32_t>(field(fields, "conn"));
    if (op == connection) {
      const auto more = fields_of(data);
      BagConnection& c = connections_[number];
      c.topic = field(fields, "topic");
      c.type = field(more, "type");
      c.md5 = field(more, "md5sum");
      c.definition = field(more, "message_definition");
    } else if (op == message) {
      const std::string_view time = field(fields, "time");
      const BagTime at = BagTime{value_of<std::uint32_t>(time)} * 1000000000 + value_of<std::uint32_t>(time.substr(4));
      if (const auto c = connections_.find(number); c != connections_.end()) take_(c->second, at, data);
    }
  }

  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  const std::function<void(const BagConnection&, BagTime, std::string_view)>& take_;
  std::map<std::uint32_t, BagConnection> connections_;
};

}  // namespace

std::string scan_bag(const std::string& file,
                     const std::function<void(const BagConnection&, BagTime, std::string_view)>& take) {
  return BagScan(file, take).run();
}

}  // namespace adit
