#include "flies/record/decompress.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>

namespace flies {
namespace {

bool from_zstd(std::string_view bytes, std::string& result) {
  const std::size_t written = ZSTD_decompress(result.data(), result.size(), bytes.data(), bytes.size());
  return ZSTD_isError(written) == 0U && written == result.size();
}

bool from_lz4(std::string_view bytes, std::string& result) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return false;
  std::size_t read = 0, written = 0, expected = 1;
  while (expected != 0 && read < bytes.size()) {
    std::size_t in = bytes.size() - read, out = result.size() - written;
    expected = LZ4F_decompress(context, result.data() + written, &out, bytes.data() + read, &in, nullptr);
    read += in;
    written += out;
    if (LZ4F_isError(expected) != 0U || (in == 0 && out == 0)) break;
  }
  LZ4F_freeDecompressionContext(context);
  return expected == 0 && written == result.size();
}

bool from_bz2(std::string_view bytes, std::string& result) {
  auto written = static_cast<unsigned>(result.size());
  std::string source(bytes);  // bzip2's interface takes no constant bytes
  return BZ2_bzBuffToBuffDecompress(result.data(), &written, source.data(), static_cast<unsigned>(source.size()), 0,
                                    0) == BZ_OK &&
         written == result.size();
}

}  // namespace

bool is_known_compression(std::string_view name) {
  constexpr std::array<std::string_view, 5> kKnown = {"", "none", "zstd", "lz4", "bz2"};
  return std::ranges::find(kKnown, name) != kKnown.end();
}

std::optional<std::string> decompress(std::string_view name, std::string_view bytes, std::uint64_t size) {
  if (size > kLargestChunk_bytes || bytes.size() > kLargestChunk_bytes) return std::nullopt;
  if (name.empty() || name == "none") return std::string(bytes);
  std::string result(size, '\0');
  const bool is_good = name == "zstd"  ? from_zstd(bytes, result)
                       : name == "lz4" ? from_lz4(bytes, result)
                                       : from_bz2(bytes, result);
  if (!is_good) return std::nullopt;
  return result;
}

}  // namespace flies
