#include "flies/io/zip_archive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

TEST(ZipArchive, AnotherProgramReadsIt) {
  if (std::system("/usr/bin/env python3 -c pass") != 0) GTEST_SKIP() << "no python3 to read it with";
  const testing::TemporaryFolder folder;
  const std::vector<ZipEntry> entries = {{"a.txt", "hello"}, {"folder/b.bin", std::string("\0\xFF\n", 3)}, {"c", ""}};
  folder.write("t.zip", zip_archive(entries));
  folder.write(
      "read.py",
      "import sys, zipfile\n"
      "z = zipfile.ZipFile(sys.argv[1])\n"
      "assert z.testzip() is None\n"
      "assert z.namelist() == ['a.txt', 'folder/b.bin', 'c'], z.namelist()\n"
      "assert z.read('a.txt') == b'hello' and z.read('folder/b.bin') == b'\\0\\xff\\n' and z.read('c') == b''\n");
  EXPECT_EQ(std::system(("python3 " + folder.file("read.py") + " " + folder.file("t.zip")).c_str()), 0);
}

TEST(ZipArchive, RefusesMoreThanItsHeadersCount) {
  EXPECT_THROW(zip_archive(std::vector<ZipEntry>(65'536, ZipEntry{"a", ""})), InputError);
  EXPECT_THROW(zip_archive(std::vector{ZipEntry{std::string(65'536, 'a'), ""}}), InputError);
  EXPECT_NO_THROW(zip_archive(std::vector<ZipEntry>(65'535, ZipEntry{"a", ""})));
}

}  // namespace
}  // namespace flies
