#include "flies/record/decompress.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>

namespace flies {
namespace {

/// What was unpacked. It grows while bytes come: a damaged chunk may claim any size.
class Output {
 public:
  Output(std::size_t packed, std::size_t size) : size_(size) {
    constexpr std::size_t kLeast = 65536, kUsualRatio = 8;
    bytes_.resize(std::min(size_, std::max(kLeast, kUsualRatio * packed)));
  }
  /// Where the next bytes go; empty when all are there.
  std::span<char> room() {
    if (written_ == bytes_.size()) bytes_.resize(std::min(size_, 2 * bytes_.size()));
    return std::span(bytes_).subspan(written_);
  }
  void wrote(std::size_t count) { written_ += count; }
  bool is_full() const { return written_ == size_; }
  std::string take() { return std::move(bytes_); }

 private:
  std::size_t size_, written_ = 0;
  std::string bytes_;
};

bool from_zstd(std::string_view bytes, Output& output) {
  constexpr int kLargestWindow = 30;  // 2^30 bytes, as the largest chunk
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context || ZSTD_isError(ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kLargestWindow)) != 0U)
    return false;
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  std::size_t expected = 0;
  while (in.pos < in.size || expected != 0) {
    const std::span<char> room = output.room();
    ZSTD_outBuffer out{room.data(), room.size(), 0};
    const std::size_t before = in.pos;
    expected = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(expected) != 0U || (out.pos == 0 && in.pos == before)) return false;
    output.wrote(out.pos);
  }
  return true;
}

bool from_lz4(std::string_view bytes, Output& output) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return false;
  std::size_t expected = 1;
  while (expected != 0) {
    const std::span<char> room = output.room();
    std::size_t in = bytes.size(), out = room.size();
    expected = LZ4F_decompress(context, room.data(), &out, bytes.data(), &in, nullptr);
    if (LZ4F_isError(expected) != 0U || (in == 0 && out == 0)) break;
    bytes.remove_prefix(in);
    output.wrote(out);
  }
  LZ4F_freeDecompressionContext(context);
  return expected == 0;
}

bool from_bz2(std::string_view bytes, Output& output) {
  std::string source(bytes);  // bzip2's interface takes no constant bytes
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  stream.next_in = source.data();
  stream.avail_in = static_cast<unsigned>(source.size());
  int state = BZ_OK;
  while (state == BZ_OK) {
    const std::span<char> room = output.room();
    stream.next_out = room.data();
    stream.avail_out = static_cast<unsigned>(room.size());
    const unsigned before = stream.avail_in;
    state = BZ2_bzDecompress(&stream);
    const std::size_t written = room.size() - stream.avail_out;
    if (written == 0 && stream.avail_in == before && state == BZ_OK) break;
    output.wrote(written);
  }
  BZ2_bzDecompressEnd(&stream);
  return state == BZ_STREAM_END;
}

}  // namespace

bool is_known_compression(std::string_view name) {
  constexpr std::array<std::string_view, 5> kKnown = {"", "none", "zstd", "lz4", "bz2"};
  return std::ranges::find(kKnown, name) != kKnown.end();
}

std::optional<std::string> decompress(std::string_view name, std::string_view bytes, std::uint64_t size) {
  if (size > kLargestChunk_bytes || bytes.size() > kLargestChunk_bytes) return std::nullopt;
  if (name.empty() || name == "none") return std::string(bytes);
  Output output(bytes.size(), size);
  const bool is_good = name == "zstd"  ? from_zstd(bytes, output)
                       : name == "lz4" ? from_lz4(bytes, output)
                                       : from_bz2(bytes, output);
  if (!is_good || !output.is_full()) return std::nullopt;
  return output.take();
}

}  // namespace flies
