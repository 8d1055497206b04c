// One example of each format that is JSON, written as its documentation says, of a rig that is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::body_from_left;
using flies::testing::body_from_right;
using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::kWritten_m;
using flies::testing::list;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::HasSubstr;

TEST(Formats, DepthAiFollowsThePosesOfSockets) {
  const TemporaryFolder folder;
  for (const bool is_fisheye : {false, true})
    for (const bool through_third : {false, true}) {
      const ToyRig rig = is_fisheye ? ToyRig::fisheye() : ToyRig();
      const auto camera = [&](int socket, const cv::Matx33d& m, std::vector<double> d, int to, const cv::Mat& pose) {
        d.resize(14, 0.0);
        return fmt::format(
            "[{}, {{\"cameraType\": {}, \"distortionCoeff\": {}, \"extrinsics\": {{\"rotationMatrix\": {}, "
            "\"specTranslation\": {{\"x\": 7.5, \"y\": 0, \"z\": 0}}, \"toCameraSocket\": {}, \"translation\": "
            "{{\"x\": {}, \"y\": {}, \"z\": {}}}}}, \"height\": 480, \"intrinsicMatrix\": {},\n\t\"lensPosition\": 0, "
            "\"width\": 640}}]",
            socket, is_fisheye ? 1 : 0, list(d), rows(pose(cv::Rect(0, 0, 3, 3))), to, 100 * pose.at<double>(0, 3),
            100 * pose.at<double>(1, 3), 100 * pose.at<double>(2, 3), rows(cv::Mat(m)));
      };
      const cv::Mat none = cv::Mat::eye(4, 4, CV_64F);
      const std::string left = through_third ? camera(1, rig.m1, rig.d1, 0, body_from_left())
                                             : camera(1, rig.m1, rig.d1, 2, right_from_left(rig));
      const std::string text = "{\"batchName\": \"\", \"boardName\": \"x\", \"cameraData\": [" +
                               camera(0, rig.m1, rig.d1, -1, none) + ", " + left + ", " +
                               camera(2, rig.m2, rig.d2, 0, body_from_right(rig)) +
                               "], \"stereoRectificationData\": {\"leftCameraSocket\": 1, \"rightCameraSocket\": 2}, "
                               "\"version\": 7}";
      const auto calibration = load_calibration(folder.write("c.json", text));
      EXPECT_EQ(calibration.format, "DepthAI calibration");
      expect_rectifies(calibration, rig);
    }
}

std::string quaternion(const cv::Mat& pose) {
  cv::Vec3d turn;
  cv::Rodrigues(pose(cv::Rect(0, 0, 3, 3)), turn);
  const double angle = cv::norm(turn);
  const cv::Vec3d q = turn / angle * std::sin(angle / 2);
  return fmt::format("{{\"px\": {}, \"py\": {}, \"pz\": {}, \"qx\": {}, \"qy\": {}, \"qz\": {}, \"qw\": {}}}",
                     pose.at<double>(0, 3), pose.at<double>(1, 3), pose.at<double>(2, 3), q[0], q[1], q[2],
                     std::cos(angle / 2));
}

TEST(Formats, BasaltOfItsLensesRectifies) {
  const TemporaryFolder folder;
  const ToyRig sphere = ToyRig::of(Lens::double_sphere, {-0.24, 0.57}, 260);
  for (const auto& [rig, type] : {std::pair{sphere, "ds"}, std::pair{ToyRig::fisheye(), "kb4"}}) {
    const bool is_sphere = rig.lens == Lens::double_sphere;
    const auto camera = [&, type = type](const cv::Matx33d& m, const std::vector<double>& d) {
      std::string text =
          fmt::format("{{\"camera_type\": \"{}\", \"intrinsics\": {{\"fx\": {}, \"fy\": {}, \"cx\": {}, \"cy\": {}",
                      type, m(0, 0), m(1, 1), m(0, 2), m(1, 2));
      text += is_sphere ? fmt::format(", \"xi\": {}, \"alpha\": {}", d[0], d[1])
                        : fmt::format(", \"k1\": {}, \"k2\": {}, \"k3\": {}, \"k4\": {}", d[0], d[1], d[2], d[3]);
      return text + "}}";
    };
    const std::string text = "{\"value0\": {\"T_imu_cam\": [" + quaternion(body_from_left()) + ", " +
                             quaternion(body_from_right(rig)) + "], \"intrinsics\": [" + camera(rig.m1, rig.d1) + ", " +
                             camera(rig.m2, rig.d2) + "], \"resolution\": [[640, 480], [640, 480]]}}";
    const auto calibration = load_calibration(folder.write("c.json", text));
    EXPECT_EQ(calibration.format, "Basalt calibration");
    expect_rectifies(calibration, rig);
  }
}

TEST(Formats, MatlabCountsFromOneAndMultipliesFromTheRight) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [&](cv::Matx33d m, const std::vector<double>& d, bool is_new) {
    m(0, 2) += 1;
    m(1, 2) += 1;
    return fmt::format(
        "{{\"RadialDistortion\": [{}, {}], \"TangentialDistortion\": [{}, {}], \"ImageSize\": [480, 640], "
        "\"WorldUnits\": \"millimeters\", \"{}\": {}}}",
        d[0], d[1], d[2], d[3], is_new ? "K" : "IntrinsicMatrix", rows(cv::Mat(is_new ? m : m.t())));
  };
  const cv::Vec3d t_mm = 1e3 * rig.t;
  for (const bool is_new : {false, true}) {
    const std::string pose =
        is_new ? fmt::format("\"PoseCamera2\": {{\"Dimensionality\": 3, \"R\": {}, \"Translation\": [{}, {}, {}]}}",
                             rows(cv::Mat(rig.r)), t_mm[0], t_mm[1], t_mm[2])
               : fmt::format("\"RotationOfCamera2\": {}, \"TranslationOfCamera2\": [{}, {}, {}]",
                             rows(cv::Mat(rig.r.t())), t_mm[0], t_mm[1], t_mm[2]);
    const auto calibration =
        load_calibration(folder.write("c.json", "{\"CameraParameters1\": " + camera(rig.m1, rig.d1, is_new) +
                                                    ", \"CameraParameters2\": " + camera(rig.m2, rig.d2, is_new) +
                                                    ", " + pose + ", \"Version\": {\"Major\": 10}}"));
    EXPECT_EQ(calibration.format, "MATLAB stereoParameters");
    EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(calibration, rig);
  }
}

TEST(Formats, MatlabsObjectsHaveTheirIntrinsicsBelowAKey) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format(
        R"({{"Intrinsics": {{"FocalLength": [{}, {}], "PrincipalPoint": [{}, {}], "ImageSize": [480, 640], )"
        R"("RadialDistortion": [{}, {}], "TangentialDistortion": [{}, {}]}}}})",
        m(0, 0), m(1, 1), m(0, 2) + 1, m(1, 2) + 1, d[0], d[1], d[2], d[3]);
  };
  const auto calibration = load_calibration(folder.write(
      "c.json", fmt::format(R"({{"CameraParameters1": {}, "CameraParameters2": {}, "PoseCamera2": {{"R": {}, )"
                            R"("Translation": {}}}}})",
                            camera(rig.m1, rig.d1), camera(rig.m2, rig.d2), rows(cv::Mat(rig.r)),
                            list({1e3 * rig.t[0], 1e3 * rig.t[1], 1e3 * rig.t[2]}))));
  EXPECT_EQ(calibration.camera.width_px, 640);
  expect_rectifies(calibration, rig);
}

TEST(Formats, MatlabMayLeaveTheSizeToTheImages) {
  const TemporaryFolder folder;
  const auto camera = [](const char* size) {
    return fmt::format(R"({{"RadialDistortion": [0, 0], "TangentialDistortion": [0, 0], "ImageSize": {}, )"
                       R"("K": [[420, 0, 320], [0, 420, 240], [0, 0, 1]]}})",
                       size);
  };
  const auto text = [&](const char* size) {
    return R"({"CameraParameters1": )" + camera(size) + R"(, "CameraParameters2": )" + camera(size) +
           R"(, "PoseCamera2": {"R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "Translation": [-120, 0, 0]}})";
  };
  CalibrationRequest request;
  request.width_px = 640;
  request.height_px = 480;
  EXPECT_EQ(load_calibration(folder.write("c.json", text("[]")), request).camera.width_px, 640);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c.json", text("[480]")), request); }),
              HasSubstr("ImageSize: found 1 number, expected 2"));
}

TEST(Formats, CityscapesSaysHowTheCameraStands) {
  const TemporaryFolder folder;
  const auto calibration = load_calibration(folder.write(
      "camera.json",
      "{\"extrinsic\": {\"baseline\": 0.209313, \"pitch\": 0.038, \"roll\": 0.0, \"x\": 1.7, \"y\": 0.1, \"yaw\": "
      "-0.02, \"z\": 1.22}, \"intrinsic\": {\"fx\": 2262.52, \"fy\": 2265.3, \"u0\": 1096.98, \"v0\": 513.137}}"));
  EXPECT_EQ(calibration.format, "Cityscapes camera.json");
  EXPECT_EQ(calibration.camera.fy_px, 2265.3);
  EXPECT_EQ(calibration.camera.baseline_m, 0.209313);
  EXPECT_EQ(calibration.camera.mount.height_m, 1.22);
  EXPECT_EQ(calibration.camera.mount.pitch_rad, 0.038);
  EXPECT_TRUE(calibration.has_height && calibration.has_pitch);
}

}  // namespace
}  // namespace flies
