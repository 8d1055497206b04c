// Coefficients of distortion under the names that people give them: they are read, or refused, but never dropped
// without a word.
#include "flies/io/formats/distortion_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

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
using flies::testing::focal_and_centre;
using flies::testing::kWritten_m;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::opencv_matrix;
using flies::testing::rectified;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kNoDistortion = "the file has no distortion coefficients";

std::string error(const TemporaryFolder& folder, const std::string& text) {
  return error_of([&] { load_calibration(folder.write("c", text)); });
}

detail::FoundDistortion read(const std::string& text, const std::string& place = "", Lens lens = Lens::brown) {
  return detail::distortion_below(parse_number_table(text, "c"), place, lens);
}

std::vector<double> four_of(const std::vector<double>& d) { return {d.begin(), d.begin() + 4}; }

std::string one_by_one(const std::vector<double>& d) {
  return fmt::format("{{\"k1\": {}, \"k2\": {}, \"p1\": {}, \"p2\": {}}}", d[0], d[1], d[2], d[3]);
}

ToyRig without_distortion() {
  ToyRig rig;
  rig.d1 = rig.d2 = {0.0, 0.0, 0.0, 0.0, 0.0};
  return rig;
}

TEST(DistortionNames, CoefficientsAreFoundBelowTheirCamera) {
  const std::string text =
      R"({"left": {"fx": 1, "distCoeffs": [1, 2, 3, 4]}, "right": {"distortion": {"K1": 5, "P2": 6}},
                               "rgb": {"radial": [1, 2, 3], "tangential": [4, 5]}, "far": {"d": 7}})";
  EXPECT_EQ(read(text, "left.").key, "left.distCoeffs");
  EXPECT_THAT(read(text, "left.").coefficients, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(read(text, "right.").coefficients, ElementsAre(5, 0, 0, 6, 0));
  EXPECT_THAT(read(text, "rgb.").coefficients, ElementsAre(1, 2, 4, 5, 3));
  EXPECT_EQ(read(text, "far.").key, "");  // a distance
}

TEST(DistortionNames, CoefficientsOneByOneAreOfTheLens) {
  EXPECT_THAT(read(R"({"k1": 1, "k2": 2, "k3": 3, "k4": 4})", "", Lens::equidistant).coefficients,
              ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(read(R"({"k1": 1, "k2": 2, "k3": 3, "k4": 4, "k5": 5, "k6": 6, "p1": 7, "p2": 8})").coefficients,
              ElementsAre(1, 2, 7, 8, 3, 4, 5, 6));
  EXPECT_THAT(read(R"({"k1": 1, "k2": 2, "k3": 3, "k4": 0, "k5": 0, "k6": 0})").coefficients,
              ElementsAre(1, 2, 0, 0, 3));
  EXPECT_THAT(error_of([] { read(R"({"k1": 1, "k2": 2, "k3": 3, "k4": 4})"); }),
              HasSubstr("c: k4: stands beside k1, k2 and k3 without p1 and p2: are they a fisheye's"));
}

TEST(DistortionNames, OnlyWhatMayBeCoefficientsIsTakenForThem) {
  const auto holds = [](const std::string& key, std::vector<double> found) {
    return detail::holds_distortion(key, {std::move(found), ""});
  };
  for (const char* key : {"d", "kc", "k", "left.dist_coeffs", "LensDistortionOfLeft", "distortion.values"})
    EXPECT_TRUE(holds(key, {-0.3, 0.1, 0, 0})) << key;
  EXPECT_FALSE(holds("dist_coeffs", {0, 0, 0, 0}));
  EXPECT_FALSE(holds("dist", {0.54}));
  EXPECT_FALSE(holds("k", {700, 700, 320, 240}));
  EXPECT_FALSE(holds("distortion_centre", {320, 240}));
  EXPECT_FALSE(holds("undistorted_view", {0, 0, 640, 480}));
}

/// @param left, right the lines on the distortion of each camera
std::string kalibr(const ToyRig& rig, const std::string& left, const std::string& right) {
  const auto camera = [](const cv::Matx33d& m, const std::string& distortion) {
    return "  camera_model: pinhole\n" + distortion + "  intrinsics: " + focal_and_centre(m) +
           "\n  resolution: [640, 480]\n";
  };
  return "cam0:\n" + camera(rig.m1, left) + "cam1:\n  T_cn_cnm1: " + rows(right_from_left(rig)) + "\n" +
         camera(rig.m2, right);
}

std::string kalibr_with(const std::string& model, const std::string& name) {
  const ToyRig rig;
  const auto lines = [&](const std::vector<double>& d) {
    return (model.empty() ? "" : "  " + model + "\n") + "  " + name + ": " + list(four_of(d)) + "\n";
  };
  return kalibr(rig, lines(rig.d1), lines(rig.d2));
}

TEST(DistortionNames, CoefficientsOfKalibrNeedTheirModel) {
  const TemporaryFolder folder;
  for (const char* model : {"", "distorsion_model: radtan"})
    EXPECT_THAT(error(folder, kalibr_with(model, "distortion_coeffs")),
                HasSubstr("c: cam0.distortion_model: is missing, and cam0.distortion_coeffs holds coefficients"));
  EXPECT_THAT(error(folder, kalibr_with("distortion_model: none", "distortion_coeffs")),
              HasSubstr("cam0.distortion_model: found 'none', and cam0.distortion_coeffs holds coefficients"));
  EXPECT_THAT(error(folder, kalibr_with("", "distorted_coeffs")),
              HasSubstr("cam0.distortion_model: is missing, and cam0.distorted_coeffs holds coefficients"));
  expect_rectifies(load_calibration(folder.write("c", kalibr_with("distortion_model: radtan", "distCoeffs"))),
                   ToyRig());
}

TEST(DistortionNames, KalibrMaySayThatALensBendsNothing) {
  const TemporaryFolder folder;
  const ToyRig straight = without_distortion();
  for (const char* line : {"  distortion_coeffs: [0, 0, 0, 0]\n", "  distortion_coeffs: []\n", ""}) {
    const std::string lines = std::string("  distortion_model: none\n") + line;
    const auto none = load_calibration(folder.write("c", kalibr(straight, lines, lines)));
    expect_rectifies(none, straight);
    EXPECT_THAT(texts(none.notes), Not(Contains(HasSubstr(kNoDistortion))));
  }
  const auto silent = load_calibration(folder.write("c", kalibr(straight, "", "")));
  expect_rectifies(silent, straight);
  EXPECT_THAT(texts(silent.notes), Contains(HasSubstr(kNoDistortion)));
}

std::string sensor(const cv::Mat& pose, const cv::Matx33d& m, const std::string& distortion) {
  return "T_BS:\n  cols: 4\n  rows: 4\n  data: " + list(numbers(pose)) +
         "\nresolution: [640, 480]\ncamera_model: pinhole\nintrinsics: " + focal_and_centre(m) +
         "\ndistortion_model: radial-tangential\n" + distortion;
}

TEST(DistortionNames, EurocMayHaveKalibrsNameAndMustHaveBothCameras) {
  const TemporaryFolder folder;
  const ToyRig rig;
  std::filesystem::create_directories(folder.file("cam0"));
  std::filesystem::create_directories(folder.file("cam1"));
  const auto of = [](const std::vector<double>& d) { return "distortion_coeffs: " + list(four_of(d)) + "\n"; };
  const auto left = folder.write("cam0/sensor.yaml", sensor(body_from_left(), rig.m1, of(rig.d1)));
  folder.write("cam1/sensor.yaml", sensor(body_from_right(rig), rig.m2, of(rig.d2)));
  expect_rectifies(load_calibration(left), rig);
  folder.write("cam1/sensor.yaml", sensor(body_from_right(rig), rig.m2, ""));
  EXPECT_THAT(error_of([&] { load_calibration(left); }),
              AllOf(HasSubstr("cam1/sensor.yaml: has no distortion coefficients, and"), HasSubstr("has some")));
}

TEST(DistortionNames, RosOfRawImagesMayNameThemAsOthersDo) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto file = [&](const char* name, const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r,
                        const cv::Mat& p) {
    return folder.write(name,
                        "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\n"
                        "distortion_coeffs: " +
                            list(d) + "\ncamera_matrix: " + list(numbers(cv::Mat(m))) + "\nrectification_matrix: " +
                            list(numbers(r)) + "\nprojection_matrix: " + list(numbers(p)) + "\n");
  };
  file("right.yaml", rig.m2, rig.d2, to.r2, to.p2);
  const auto left = file("left.yaml", rig.m1, rig.d1, to.r1, to.p1);
  expect_rectifies(load_calibration(left, of_raw_images()), rig);
  EXPECT_THAT(texts(load_calibration(left).notes), Contains(HasSubstr("the distortion coefficients are ignored")));
}

TEST(DistortionNames, VinsMayNameThemAsOthersDo) {
  const TemporaryFolder folder;
  const auto load = [&](const ToyRig& rig, bool has_distortion) {
    const auto file = [&](const char* name, const cv::Matx33d& m, const std::vector<double>& d) {
      folder.write(name, fmt::format("%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 640\nimage_height: 480\n"
                                     "projection_parameters: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n",
                                     m(0, 0), m(1, 1), m(0, 2), m(1, 2)) +
                             (has_distortion ? fmt::format("distortion:\n   k1: {}\n   k2: {}\n   p1: {}\n   p2: {}\n",
                                                           d[0], d[1], d[2], d[3])
                                             : ""));
    };
    file("0.yaml", rig.m1, rig.d1);
    file("1.yaml", rig.m2, rig.d2);
    return load_calibration(folder.write("c.yaml", "%YAML:1.0\n---\ncam0_calib: \"0.yaml\"\ncam1_calib: \"1.yaml\"\n" +
                                                       opencv_matrix("body_T_cam0", body_from_left()) +
                                                       opencv_matrix("body_T_cam1", body_from_right(rig))));
  };
  expect_rectifies(load({}, true), ToyRig());
  EXPECT_THAT(texts(load(without_distortion(), false).notes), Contains(HasSubstr(kNoDistortion)));
}

std::string fx_and_more(const cv::Matx33d& m) {
  return fmt::format("\"fx\": {}, \"fy\": {}, \"cx\": {}, \"cy\": {}", m(0, 0), m(1, 1), m(0, 2), m(1, 2));
}

std::string pose_of_rig(const ToyRig& rig) {
  return "\"R\": " + rows(cv::Mat(rig.r)) + ", \"T\": " + list(numbers(cv::Mat(rig.t)));
}

/// A dump of two cameras; `{0}` stands for fx and its like, `{1}` for coefficients as a list, `{2}` as a map.
std::string dump(const ToyRig& rig, const std::string& left, const std::string& right) {
  const auto side = [](const std::string& form, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format(fmt::runtime(form), fx_and_more(m), list(four_of(d)), one_by_one(d));
  };
  return "{\"width\": 640, \"height\": 480, " + side(left, rig.m1, rig.d1) + ", " + side(right, rig.m2, rig.d2) + ", " +
         pose_of_rig(rig) + "}";
}

std::string dump(const ToyRig& rig, const std::string& camera) {
  return dump(rig, "\"left\": " + camera, "\"right\": " + camera);
}

TEST(DistortionNames, DumpsNameThemAsTheyLike) {
  const TemporaryFolder folder;
  for (const char* name : {"D", "d", "coeffs", "coefficients", "dist", "disto", "Disto", "distortion", "Distortion",
                           "dist_coeff", "dist_coeffs", "distCoeffs", "distortion_coeffs", "distortion_coefficients",
                           "distortion_params", "distortion_parameters"}) {
    SCOPED_TRACE(name);
    const auto text = dump({}, fmt::format("{{{{ {{0}}, \"{}\": {{1}} }}}}", name));
    expect_rectifies(load_calibration(folder.write("c", text)), ToyRig());
  }
}

TEST(DistortionNames, DumpsMayNestThem) {
  const TemporaryFolder folder;
  for (const char* camera :
       {"{{ {0}, \"distortion\": {2} }}", "{{ \"intrinsics\": {{ {0} }}, \"distortion\": {1} }}",
        "{{ \"intrinsics\": {{ {0} }}, \"distortion\": {2} }}", "{{ \"intrinsics\": {{ {0}, \"coeffs\": {1} }} }}",
        "{{ {0}, \"distortion\": {{ \"coefficients\": {1} }} }}"}) {
    SCOPED_TRACE(camera);
    expect_rectifies(load_calibration(folder.write("c", dump({}, camera))), ToyRig());
  }
  const auto beside = dump({}, "\"M1\": {{ {0} }}, \"D1\": {1}", "\"M2\": {{ {0} }}, \"D2\": {1}");
  expect_rectifies(load_calibration(folder.write("c", beside)), ToyRig());
}

TEST(DistortionNames, DumpsOfTheRationalModelKeepItsDenominator) {
  const TemporaryFolder folder;
  ToyRig rig;
  rig.d1 = rig.d2 = {-0.28, 0.07, 0.0005, -0.0003, 0.0, 0.2, 0.05, 0.01};
  const auto text =
      dump(rig,
           "{{ {0}, \"k1\": -0.28, \"k2\": 0.07, \"p1\": 0.0005, \"p2\": -0.0003, \"k3\": 0, \"k4\": 0.2, "
           "\"k5\": 0.05, \"k6\": 0.01 }}");
  expect_rectifies(load_calibration(folder.write("c", text)), rig);
}

TEST(DistortionNames, DumpsThatNameThemOtherwiseAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(error(folder, dump({}, "{{ {0}, \"lens_distortion_by_opencv\": {1} }}")),
              HasSubstr("c: left.lens_distortion_by_opencv: found 4 numbers: are they distortion coefficients?"));
  EXPECT_THAT(error(folder, dump({}, "\"left\": {{ {0}, \"D\": {1} }}", "\"right\": {{ {0} }}")),
              HasSubstr("c: right: has no distortion coefficients, and left has some"));
}

TEST(DistortionNames, DumpsOfRectifiedCamerasStayRectified) {
  const TemporaryFolder folder;
  const std::string camera = "{\"fx\": 400, \"fy\": 400, \"cx\": 320, \"cy\": 240";
  for (const char* distortion :
       {"", ", \"dist_coeffs\": [0, 0, 0, 0, 0]", ", \"distortion\": {\"k1\": 0, \"k2\": 0}"}) {
    SCOPED_TRACE(distortion);
    const auto calibration =
        load_calibration(folder.write("c", "{\"left\": " + camera + distortion + "}, \"right\": " + camera +
                                               distortion + "}, \"width\": 640, \"height\": 480, \"baseline\": 0.12}"));
    EXPECT_FALSE(calibration.rectifier.has_value());
    EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("distortion"))));
  }
}

TEST(DistortionNames, MrptMayNameThemAsOthersDoOrHaveNone) {
  const TemporaryFolder folder;
  const auto load = [&](const ToyRig& rig, const char* name) {
    const auto camera = [&](const char* side, const cv::Matx33d& m, const std::vector<double>& d) {
      return fmt::format("[CAMERA_PARAMS_{}]\nresolution = [640 480]\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n", side,
                         m(0, 0), m(1, 1), m(0, 2), m(1, 2)) +
             (std::string(name).empty() ? "" : fmt::format("{} = [{}]\n", name, fmt::join(d, " ")));
    };
    const cv::Mat pose = right_from_left(rig).inv();
    cv::Vec3d axis;
    cv::Rodrigues(pose(cv::Rect(0, 0, 3, 3)), axis);
    const double angle = cv::norm(axis), sine = std::sin(angle / 2) / angle;
    return load_calibration(folder.write(
        "c.ini", camera("LEFT", rig.m1, rig.d1) + camera("RIGHT", rig.m2, rig.d2) +
                     fmt::format("[CAMERA_PARAMS_LEFT2RIGHT_POSE]\npose_quaternion = [{} {} {} {} {} {} {}]\n",
                                 pose.at<double>(0, 3), pose.at<double>(1, 3), pose.at<double>(2, 3),
                                 std::cos(angle / 2), sine * axis[0], sine * axis[1], sine * axis[2])));
  };
  expect_rectifies(load({}, "distCoeffs"), ToyRig());
  EXPECT_THAT(texts(load(without_distortion(), "").notes), Contains(HasSubstr(kNoDistortion)));
}

std::string orb_slam3(const std::string& left, const std::string& right, const std::string& more) {
  const std::string camera = "fx: 420\n{0}.fy: 420\n{0}.cx: 320\n{0}.cy: 240\n";
  const auto named = [&](const char* name) { return fmt::format(fmt::runtime("{0}." + camera), name); };
  return "%YAML:1.0\nCamera.type: \"PinHole\"\n" + named("Camera1") + left + named("Camera2") + right + more +
         "Camera.width: 640\nCamera.height: 480\n" + opencv_matrix("Stereo.T_c1_c2", right_from_left(ToyRig()).inv());
}

TEST(DistortionNames, OrbSlam3NeedsThemOfBothCameras) {
  const TemporaryFolder folder;
  EXPECT_THAT(error(folder, orb_slam3("Camera1.k1: -0.3\nCamera1.k2: 0.1\n", "", "")),
              HasSubstr("c: Camera2.fx: has no distortion coefficients, and Camera1.fx has some"));
  EXPECT_THAT(error(folder, orb_slam3("", "", "Camera.k1: -0.3\nCamera.k2: 0.1\n")),
              HasSubstr("c: Camera.k1: stands beside Camera1.fx and Camera2.fx"));
  EXPECT_THAT(texts(load_calibration(folder.write("c", orb_slam3("", "", "Camera.k1: 0\n"))).notes),
              Contains(HasSubstr(kNoDistortion)));
}

/// OpenCV's names, but for those of the coefficients.
std::string matrices(const ToyRig& rig, const std::string& left, const std::string& right) {
  return "{\"width\": 640, \"height\": 480, \"K_left\": " + rows(cv::Mat(rig.m1)) +
         ", \"K_right\": " + rows(cv::Mat(rig.m2)) + ", " + left + ", " + right + ", " + pose_of_rig(rig) + "}";
}

TEST(DistortionNames, MatricesOfOpenCvMayStandBesideMapsAndOtherNames) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto expect = [&](const std::string& left, const std::string& right) {
    SCOPED_TRACE(left);
    expect_rectifies(load_calibration(folder.write("c", matrices(rig, left, right))), rig);
  };
  expect("\"D1\": " + one_by_one(rig.d1), "\"D2\": " + one_by_one(rig.d2));
  expect("\"left\": {\"distortion\": " + one_by_one(rig.d1) + "}",
         "\"right\": {\"distortion\": " + one_by_one(rig.d2) + "}");
  for (const char* name : {"coeffs", "kc", "lens_distortion", "distortion_parameters"})
    expect(fmt::format("\"{}_left\": {}", name, list(rig.d1)), fmt::format("\"{}_right\": {}", name, list(rig.d2)));
  const auto each = [](const char* side, const std::vector<double>& d) {
    return fmt::format("\"k1_{0}\": {1}, \"k2_{0}\": {2}, \"p1_{0}\": {3}, \"p2_{0}\": {4}", side, d[0], d[1], d[2],
                       d[3]);
  };
  expect(each("left", rig.d1), each("right", rig.d2));
  const auto radial = [](const char* side, const std::vector<double>& d) {
    return fmt::format("\"radial_{0}\": [{1}, {2}], \"tangential_{0}\": [{3}, {4}]", side, d[0], d[1], d[2], d[3]);
  };
  expect(radial("left", rig.d1), radial("right", rig.d2));
}

TEST(DistortionNames, MatlabWithoutThemSaysWhichAreMissing) {
  const TemporaryFolder folder;
  const std::string camera =
      "{\"IntrinsicMatrix\": [[420, 0, 0], [0, 420, 0], [321, 241, 1]], \"Radial\": [-0.3, 0.1]}";
  EXPECT_THAT(error(folder, "{\"CameraParameters1\": " + camera + ", \"CameraParameters2\": " + camera + "}"),
              HasSubstr("c: CameraParameters1.RadialDistortion: is missing"));
}

// Where the right camera stands, under the names that scripts give it.

TEST(DistortionNames, PosesBelowTheRightCameraAreRead) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto text = [&](const std::string& pose_of_left, const std::string& more) {
    return "{\"width\": 640, \"height\": 480, \"left\": {" + fx_and_more(rig.m1) + ", \"D\": " + list(rig.d1) +
           pose_of_left + "}, \"right\": {" + fx_and_more(rig.m2) + ", \"D\": " + list(rig.d2) + ", " +
           pose_of_rig(rig) + "}" + more + "}";
  };
  const std::string no_pose = ", \"R\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"T\": [0, 0, 0]";
  const std::string baseline = fmt::format(", \"baseline\": {}", cv::norm(rig.t));
  for (const auto& form : {text("", ""), text("", baseline), text(no_pose, "")})
    expect_rectifies(load_calibration(folder.write("c", form)), rig);
  const std::string elsewhere = ", \"R\": [[0, 0, 1], [1, 0, 0], [0, 1, 0]], \"T\": [1, 2, 3]";
  EXPECT_THAT(error(folder, text(elsewhere, "")), HasSubstr("baseline (or R and T"));
}

TEST(DistortionNames, TranslationsMayBeMapsOrNameTheirUnit) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto text = [&](const std::string& translation) {
    return "{\"width\": 640, \"height\": 480, \"M1\": " + rows(cv::Mat(rig.m1)) + ", \"D1\": " + list(rig.d1) +
           ", \"M2\": " + rows(cv::Mat(rig.m2)) + ", \"D2\": " + list(rig.d2) + ", \"R\": " + rows(cv::Mat(rig.r)) +
           ", " + translation + "}";
  };
  for (const auto& translation :
       {fmt::format("\"T\": {{\"z\": {}, \"y\": {}, \"x\": {}}}", rig.t[2], rig.t[1], rig.t[0]),
        "\"T_mm\": " + list(numbers(cv::Mat(1000.0 * rig.t))),
        "\"translation_cm\": " + list(numbers(cv::Mat(100.0 * rig.t)))}) {
    SCOPED_TRACE(translation);
    const auto calibration = load_calibration(folder.write("c", text(translation)));
    EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(calibration, rig);
  }
}

}  // namespace
}  // namespace flies
