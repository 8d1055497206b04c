#include "flies/io/placeholder.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/images.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/text_file.hpp"

namespace flies::detail {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(PlaceholderFault, NamesWhatStandsWhereAFileShouldBe) {
  EXPECT_THAT(placeholder_fault("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(placeholder_fault("/annex/objects/SHA256E-s1234--9f86d0.png\n"), HasSubstr("git annex get"));
  EXPECT_THAT(placeholder_fault("outs:\n- md5: 22a1a2931c8370d3aeedd7183606fd7f\n  size: 14445097\n  path: l.png\n"),
              HasSubstr("dvc pull"));
  EXPECT_THAT(placeholder_fault("\n<!DOCTYPE html>\n<html><body>404 Not Found</body></html>"), HasSubstr("web page"));
  EXPECT_THAT(placeholder_fault("\xEF\xBB\xBF<HTML>"), HasSubstr("web page"));
  EXPECT_THAT(placeholder_fault("../../kitti/image_00/data/0000000003.png"),
              AllOf(HasSubstr("symbolic link"), HasSubstr("'../../kitti/image_00/data/0000000003.png'")));
  EXPECT_THAT(placeholder_fault("000003.png\n"), HasSubstr("'000003.png'"));
  EXPECT_THAT(placeholder_fault("!<symlink>left.png"), HasSubstr("'left.png'"));
  EXPECT_THAT(placeholder_fault(std::string(5000, '\0')), HasSubstr("zeros"));
}

TEST(PlaceholderFault, IsNothingForFilesThatAreShort) {
  for (const char* text : {"", "fx: 700\nfy: 700\n", "0.1", "1698765432.1039", "0.0\n0.1\n0.2\n", "{}",
                           "0.54 721.5 721.5 609.6 172.9", "P5 1 1 255 a", "<opencv_storage>", "left.png right.png"})
    EXPECT_THAT(placeholder_fault(text), IsEmpty()) << text;
}

TEST(DeadLinkFault, NamesWhereALinkLeads) {
  const testing::TemporaryFolder folder;
  const auto link = [&](const std::string& name, const std::string& target) {
    std::filesystem::create_symlink(target, folder.file(name));
    return folder.file(name);
  };
  folder.write("there.png", "");
  EXPECT_THAT(dead_link_fault(link("dead.png", "nowhere.png")), HasSubstr("to 'nowhere.png', which does not exist"));
  EXPECT_THAT(dead_link_fault(link("annexed.png", ".git/annex/objects/x.png")), HasSubstr("git annex get"));
  EXPECT_THAT(dead_link_fault(link("good.png", "there.png")), IsEmpty());
  EXPECT_THAT(dead_link_fault(folder.file("there.png")), IsEmpty());
  EXPECT_THAT(dead_link_fault(folder.file("absent.png")), IsEmpty());
  EXPECT_THAT(testing::error_of([&] { read_file(folder.file("dead.png"), 100); }), HasSubstr("'nowhere.png'"));
}

TEST(PlaceholderFault, IsToldOfEveryFileThatIsRead) {
  const testing::TemporaryFolder folder;
  const auto pointer = folder.write("left.png", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n");
  const auto nothing = folder.write("nothing.png", "");
  for (const auto& [path, words] : {std::pair(pointer, "git lfs pull"), std::pair(nothing, "is empty")}) try {
      load_gray_image(path);
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
}

}  // namespace
}  // namespace flies::detail
