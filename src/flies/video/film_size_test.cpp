#include "flies/video/film_size.hpp"

#include <gtest/gtest.h>

#include <string>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using namespace std::string_literals;

struct FilmSize : ::testing::Test {
  bool is_lacking(const std::string& bytes) const {
    folder.write("film", bytes);
    return lacks_its_end(folder.file("film"));
  }
  testing::TemporaryFolder folder;
};

const std::string kBody(100, 'x');

TEST_F(FilmSize, Mp4HasWholeBoxes) {
  const std::string film =
      "\0\0\0\x10"
      "ftypisomxxxx\0\0\0\x6Cmdat"s +
      kBody;
  EXPECT_FALSE(is_lacking(film));
  EXPECT_TRUE(is_lacking(film.substr(0, film.size() - 1)));
  EXPECT_TRUE(
      is_lacking("\0\0\0\x10"
                 "ftypisomxxxx\0\0\0\x01mdat\0\0\0\0\0\0\0\xFF"s +
                 kBody));
  EXPECT_FALSE(
      is_lacking("\0\0\0\x10"
                 "ftypisomxxxx\0\0\0\0mdat"s +
                 kBody))
      << "to the end of the file";
}

TEST_F(FilmSize, AviHasAsMuchAsItSays) {
  EXPECT_FALSE(is_lacking("RIFF\x64\0\0\0"s + kBody));
  EXPECT_TRUE(is_lacking("RIFF\x65\0\0\0"s + kBody));
}

TEST_F(FilmSize, MatroskaHasItsSegment) {
  const std::string head = "\x1A\x45\xDF\xA3\x83xxx\x18\x53\x80\x67"s;
  EXPECT_FALSE(is_lacking(head + "\xE4"s + kBody));
  EXPECT_TRUE(is_lacking(head + "\xE5"s + kBody));
  EXPECT_TRUE(is_lacking(head + "\x01\0\0\0\0\0\0\x65"s + kBody));
  EXPECT_FALSE(is_lacking(head + "\xFF"s + kBody)) << "size not known";
}

TEST_F(FilmSize, ZerosAtTheEndAreNone) { EXPECT_TRUE(is_lacking("RIFF\x08\x20\0\0"s + std::string(8192, '\0'))); }

TEST_F(FilmSize, OtherFilesPass) {
  EXPECT_FALSE(is_lacking("FLV" + kBody));
  EXPECT_FALSE(is_lacking(""));
  EXPECT_FALSE(lacks_its_end(folder.file("absent")));
}

}  // namespace
}  // namespace flies
