// Rotations and poses in the forms that people write them, each of a rig that is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

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
using flies::testing::rectified;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<double> rotation_vector(const cv::Mat& rotation) {
  cv::Mat vector;
  cv::Rodrigues(rotation, vector);
  return numbers(vector);
}

/// w x y z
std::vector<double> quaternion(const cv::Mat& rotation) {
  const auto v = rotation_vector(rotation);
  const double angle = std::hypot(v[0], v[1], v[2]), share = std::sin(angle / 2) / angle;
  return {std::cos(angle / 2), share * v[0], share * v[1], share * v[2]};
}

std::string entry(const std::string& key, const std::string& value) { return key + ": " + value + "\n"; }

std::string opencv(const ToyRig& rig, const std::string& pose) {
  return "%YAML:1.0\n---\nimage_size: [640, 480]\n" + entry("M1", rows(cv::Mat(rig.m1))) + entry("D1", list(rig.d1)) +
         entry("M2", rows(cv::Mat(rig.m2))) + entry("D2", list(rig.d2)) + pose;
}

std::string t_of(const ToyRig& rig) { return entry("T", list(numbers(cv::Mat(rig.t)))); }

TEST(Poses, RotationVectorsAndQuaternionsOfOpenCvRectifyAsTheMatrixDoes) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto vector = rotation_vector(cv::Mat(rig.r));
  const auto q = quaternion(cv::Mat(rig.r));
  const std::string in_column = fmt::format("[[{}], [{}], [{}]]", vector[0], vector[1], vector[2]);
  for (const std::string& pose :
       {entry("R", list(vector)), entry("R", in_column), entry("rvec", list(vector)), entry("om", list(vector)),
        entry("R", list(q)), entry("R", list({q[1], q[2], q[3], q[0]}))}) {
    SCOPED_TRACE(pose);
    const auto calibration = load_calibration(folder.write("c", opencv(rig, pose + t_of(rig))));
    expect_rectifies(calibration, rig);
    EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("is read as a")));
  }
  const std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<imageSize>640 480</imageSize>\n<M1><data>{}</data></M1>\n"
      "<D1><data>{}</data></D1>\n<M2><data>{}</data></M2>\n<D2><data>{}</data></D2>\n<R><rows>3</rows><data>{}</data>"
      "</R>\n<T><data>{}</data></T>\n</opencv_storage>\n",
      fmt::join(numbers(cv::Mat(rig.m1)), " "), fmt::join(rig.d1, " "), fmt::join(numbers(cv::Mat(rig.m2)), " "),
      fmt::join(rig.d2, " "), fmt::join(vector, " "), fmt::join(numbers(cv::Mat(rig.t)), " "));
  expect_rectifies(load_calibration(folder.write("c.xml", xml)), rig);
}

TEST(Poses, RotationVectorsOfOtherFormatsRectifyAsTheMatrixDoes) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto info = [](const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r, const cv::Mat& p) {
    return "height: 480\nwidth: 640\ndistortion_model: plumb_bob\n" + entry("d", list(d)) +
           entry("k", list(numbers(cv::Mat(m)))) + entry("r", list(rotation_vector(r))) + entry("p", list(numbers(p)));
  };
  folder.write("right.yaml", info(rig.m2, rig.d2, to.r2, to.p2));
  expect_rectifies(load_calibration(folder.write("left.yaml", info(rig.m1, rig.d1, to.r1, to.p1)), of_raw_images()),
                   rig);
  const auto row = [](const std::string& key, const std::vector<double>& values) {
    return fmt::format("{}: {}\n", key, fmt::join(values, " "));
  };
  const auto side = [&](const char* number, const cv::Matx33d& m, const std::vector<double>& d,
                        const std::vector<double>& r, const std::vector<double>& t) {
    const std::string of = number;
    return row("S_" + of, {640, 480}) + row("K_" + of, numbers(cv::Mat(m))) + row("D_" + of, d) + row("R_" + of, r) +
           row("T_" + of, t) + row("P_rect_" + of, {400, 0, 320, of == "00" ? 0.0 : -48.0, 0, 400, 240, 0, 0, 0, 1, 0});
  };
  auto request = of_raw_images();
  request.cameras = {0, 1};
  const std::string kitti = side("00", rig.m1, rig.d1, {0, 0, 0}, {0, 0, 0}) +
                            side("01", rig.m2, rig.d2, rotation_vector(cv::Mat(rig.r)), numbers(cv::Mat(rig.t)));
  expect_rectifies(load_calibration(folder.write("c.txt", kitti), request), rig);
}

TEST(Poses, RotationVectorsInDegreesAreRefused) {
  const TemporaryFolder folder;
  const ToyRig rig;
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", opencv(rig, "R: [1.1, -1.7, 0.9]\n" + t_of(rig)))); }),
              HasSubstr("degrees where radians are expected"));
  const auto turned = load_calibration(folder.write("c", opencv(rig, "R: [0.0, 0.6, 0.0]\n" + t_of(rig))));
  EXPECT_THAT(texts(turned.notes), Contains(HasSubstr("turns the right camera by 34.4 degrees")));
  const auto level = load_calibration(folder.write("c", opencv(rig, entry("R", rows(cv::Mat(rig.r))) + t_of(rig))));
  EXPECT_THAT(texts(level.notes), Not(Contains(HasSubstr("turns the right"))));
  EXPECT_THAT(texts(level.notes), Not(Contains(HasSubstr("is read as a"))));
  EXPECT_THAT(
      error_of([&] { load_calibration(folder.write("c", opencv(rig, "R: [0.5, 0.5, 0.5, 0.5]\n" + t_of(rig)))); }),
      HasSubstr("R: found 4 numbers"));
}

/// A pose in every order that only it can be.
std::vector<std::string> orders_of(const cv::Mat& pose) {
  const cv::Mat upper = pose.rowRange(0, 3), across = pose.t(), upper_across = upper.t();
  return {rows(pose),   list(numbers(pose)),   rows(upper),        list(numbers(upper)),
          rows(across), list(numbers(across)), rows(upper_across), list(numbers(upper_across))};
}

TEST(Poses, AreReadByRowsAndByColumns) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto kalibr = [&](const cv::Matx33d& m, const std::vector<double>& d) {
    return "  camera_model: pinhole\n  distortion_model: radtan\n  resolution: [640, 480]\n  distortion_coeffs: " +
           list({d[0], d[1], d[2], d[3]}) + "\n  intrinsics: " + focal_and_centre(m) + "\n";
  };
  int order = 0;
  for (const std::string& pose : orders_of(right_from_left(rig))) {
    SCOPED_TRACE(pose);
    const auto of_kalibr = load_calibration(folder.write(
        "c", "cam0:\n" + kalibr(rig.m1, rig.d1) + "cam1:\n  T_cn_cnm1: " + pose + "\n" + kalibr(rig.m2, rig.d2)));
    expect_rectifies(of_kalibr, rig);
    const bool is_told = order++ >= 4;
    EXPECT_EQ(
        std::ranges::any_of(of_kalibr.notes,
                            [](const CalibrationNote& note) { return note.text.find("transposed") != note.text.npos; }),
        is_told);
    expect_rectifies(load_calibration(folder.write("c", opencv(rig, entry("T", pose)))), rig);
    expect_rectifies(load_calibration(folder.write("c", opencv(rig, entry("RT", pose)))), rig);
  }
}

TEST(Poses, OfKalibrsCamerasAgainstTheInertialUnitRectify) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [](const std::string& pose, const cv::Matx33d& m, const std::vector<double>& d) {
    return "  camera_model: pinhole\n  distortion_model: radtan\n  resolution: [640, 480]\n  distortion_coeffs: " +
           list({d[0], d[1], d[2], d[3]}) + "\n  intrinsics: " + focal_and_centre(m) + "\n  " + pose + "\n";
  };
  const cv::Mat left = body_from_left(), right = body_from_right(rig);
  for (const std::string name : {"T_cam_imu", "T_cam_body", "T_imu_cam", "T_B_C"}) {
    const auto pose = [&](const cv::Mat& body_from_camera) {
      return name + ": " + rows(name.starts_with("T_cam") ? cv::Mat(body_from_camera.inv()) : body_from_camera);
    };
    expect_rectifies(load_calibration(folder.write("c", "cam0:\n" + camera(pose(left), rig.m1, rig.d1) + "cam1:\n" +
                                                            camera(pose(right), rig.m2, rig.d2))),
                     rig);
  }
  const auto transposed =
      load_calibration(folder.write("c", "cam0:\n" + camera("T_imu_cam: " + rows(left.t()), rig.m1, rig.d1) +
                                             "cam1:\n" + camera("T_imu_cam: " + rows(right), rig.m2, rig.d2)));
  expect_rectifies(transposed, rig);
  EXPECT_THAT(texts(transposed.notes), Contains(HasSubstr("cam0.T_imu_cam is transposed")));
}

TEST(Poses, OfBodiesAreReadByRowsAndByColumns) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto sensor = [](const std::string& pose, const cv::Matx33d& m, const std::vector<double>& d) {
    return "T_BS:\n  data: " + pose +
           "\nresolution: [640, 480]\ndistortion_model: radial-tangential\nintrinsics: " + focal_and_centre(m) +
           "\ndistortion_coefficients: " + list({d[0], d[1], d[2], d[3]}) + "\n";
  };
  const auto left = orders_of(body_from_left()), right = orders_of(body_from_right(rig));
  for (std::size_t i = 0; i < left.size(); ++i) {
    SCOPED_TRACE(left[i]);
    folder.write("right.yaml", sensor(right[i], rig.m2, rig.d2));
    expect_rectifies(load_calibration(folder.write("left.yaml", sensor(left[i], rig.m1, rig.d1))), rig);
  }
}

/// A body whose x points ahead, as a car's: its z is up, and the left camera stands 0.3 m ahead of its origin.
cv::Mat car_from_left() { return (cv::Mat_<double>(4, 4) << 0, 0, 1, 0.3, -1, 0, 0, 0.1, 0, -1, 0, 1.2, 0, 0, 0, 1); }

TEST(Poses, ThatAreInverseOrInMillimetresAreToldSo) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto sensor = [](const cv::Mat& pose, const cv::Matx33d& m, const std::vector<double>& d) {
    return "T_BS: " + list(numbers(pose)) +
           "\nresolution: [640, 480]\ndistortion_model: radial-tangential\nintrinsics: " + focal_and_centre(m) +
           "\ndistortion_coefficients: " + list({d[0], d[1], d[2], d[3]}) + "\n";
  };
  const cv::Mat left = car_from_left(), right = left * right_from_left(rig).inv();
  const auto load = [&](const cv::Mat& of_left, const cv::Mat& of_right) {
    folder.write("right.yaml", sensor(of_right, rig.m2, rig.d2));
    return load_calibration(folder.write("left.yaml", sensor(of_left, rig.m1, rig.d1)));
  };
  expect_rectifies(load(left, right), rig);
  EXPECT_THAT(error_of([&] { load(left.inv(), right.inv()); }),
              HasSubstr("T_BS: the poses of both cameras seem to be the inverse ones: inverted, they put the cameras "
                        "side by side, 0.12"));
  cv::Mat in_mm = right.clone();
  in_mm(cv::Rect(3, 0, 1, 3)) *= 1000.0;
  EXPECT_THAT(error_of([&] { load(left, in_mm); }),
              HasSubstr("T_BS: the translation of the right camera seems to be in millimetres"));
}

TEST(Poses, ThatAreNoneAreRefused) {
  const TemporaryFolder folder;
  const ToyRig rig;
  EXPECT_THAT(
      error_of([&] {
        load_calibration(folder.write("c", opencv(rig, "RT: [1, 0, 0, -0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0.2, 0, 0, 1]\n")));
      }),
      HasSubstr("RT: is no pose"));
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", opencv(rig, "RT: [1, 0, 0, -0.1]\n"))); }),
              HasSubstr("RT: found 4 numbers, expected 16"));
}

TEST(OpenCvNames, ThatPeopleGiveTheirMatricesAreKnown) {
  const TemporaryFolder folder;
  const ToyRig rig;
  using Names = std::vector<std::string>;
  for (const Names& name :
       {Names{"cameraMatrixL", "distCoeffL", "cameraMatrixR", "distCoeffR", "R", "T"},
        Names{"K1", "d1", "K2", "d2", "R", "t"},
        Names{"camera_matrix_left", "dist_coeffs_left", "camera_matrix_right", "dist_coeffs_right", "rot", "trans"},
        Names{"left_camera_matrix", "left_distortion", "right_camera_matrix", "right_distortion", "R", "T"},
        Names{"mtxL", "distL", "mtxR", "distR", "Rot", "Trns"}, Names{"mtx1", "dist1", "mtx2", "dist2", "R", "T"},
        Names{"K_LEFT", "DISTO_LEFT", "K_RIGHT", "DISTO_RIGHT", "R", "T"}, Names{"K_l", "D_l", "K_r", "D_r", "R", "T"},
        Names{"K_0", "D_0", "K_1", "D_1", "R", "T"}, Names{"CM1", "dist1", "CM2", "dist2", "R", "T"},
        Names{"newCameraMatrixL", "distL", "newCameraMatrixR", "distR", "rot", "trans"},
        Names{"new_mtxL", "distL", "new_mtxR", "distR", "Rot", "Trns"},
        Names{"cam_mats_left", "dist_coefs_left", "cam_mats_right", "dist_coefs_right", "rot_mat", "trans_vec"},
        Names{"Camera_Matrix_1", "Distortion_Coefficients_1", "Camera_Matrix_2", "Distortion_Coefficients_2",
              "Rotation_Matrix", "Translation_Vector"}}) {
    SCOPED_TRACE(name[0]);
    const std::string text = entry(name[0], rows(cv::Mat(rig.m1))) + entry(name[1], list(rig.d1)) +
                             entry(name[2], rows(cv::Mat(rig.m2))) + entry(name[3], list(rig.d2)) +
                             entry(name[4], rows(cv::Mat(rig.r))) + entry(name[5], list(numbers(cv::Mat(rig.t))));
    CalibrationRequest request;
    request.width_px = 640;
    request.height_px = 480;
    expect_rectifies(load_calibration(folder.write("c", text), request), rig);
  }
}

// As zed-opencv-calibration of Stereolabs writes them, but for its millimetres.
TEST(OpenCvNames, MaySayThatLensesAreFisheyes) {
  const TemporaryFolder folder;
  const ToyRig rig = ToyRig::fisheye();
  const auto text = [&](const std::string& left, const std::string& right) {
    return entry("Size", "[640, 480]") + entry("K_LEFT", rows(cv::Mat(rig.m1))) +
           entry("K_RIGHT", rows(cv::Mat(rig.m2))) + entry(left, list(rig.d1)) + entry(right, list(rig.d2)) +
           entry("R", rows(cv::Mat(rig.r))) + entry("T", list(numbers(cv::Mat(rig.t))));
  };
  expect_rectifies(load_calibration(folder.write("c", text("D_LEFT_FE", "D_RIGHT_FE"))), rig);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", text("Dist_of_A", "Dist_of_B"))); }),
              HasSubstr("Dist_of_A: found 4 numbers: are they distortion coefficients?"));
}

TEST(OpenCvNames, CountedFromZeroAreNotThoseOfKitti) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const std::string raw = entry("K0", rows(cv::Mat(rig.m1))) + entry("D0", list(rig.d1)) +
                          entry("K1", rows(cv::Mat(rig.m2))) + entry("D1", list(rig.d2)) +
                          entry("R", rows(cv::Mat(rig.r))) + entry("T", list(numbers(cv::Mat(rig.t))));
  const auto calibration = load_calibration(
      folder.write("c", raw + "P0: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n"
                              "P1: [400, 0, 320, -48, 0, 400, 240, 0, 0, 0, 1, 0]\nimage_size: [640, 480]\n"));
  EXPECT_EQ(calibration.format, "OpenCV stereo");
  EXPECT_EQ(calibration.camera.width_px, 640);
  EXPECT_NEAR(calibration.camera.baseline_m, 0.12, kWritten_m);
}

TEST(OpenCvNames, MayStandBelowTheirCamera) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return "{\"K\": " + rows(cv::Mat(m)) + ", \"dist\": [" + list(d) + "]}";
  };
  for (const auto& [left, right] : {std::pair{"left", "right"}, std::pair{"camera1", "camera2"}}) {
    const std::string text = fmt::format(
        "{{\"{}\": {}, \"{}\": {}, \"stereo\": {{\"R\": {}, \"T\": {}}}, \"image_size\": [640, 480]}}", left,
        camera(rig.m1, rig.d1), right, camera(rig.m2, rig.d2), rows(cv::Mat(rig.r)), list(numbers(cv::Mat(rig.t))));
    expect_rectifies(load_calibration(folder.write("c.json", text)), rig);
  }
}

TEST(Rectifying, ImagesThatWereResizedByTwoScales) {
  const TemporaryFolder folder;
  ToyRig rig;
  const auto file = folder.write("c", opencv(rig, entry("R", rows(cv::Mat(rig.r))) + t_of(rig)));
  CalibrationRequest request;
  request.width_px = 800;
  request.height_px = 540;
  EXPECT_FALSE(load_calibration(file, request).camera.width_px == request.width_px);
  request.images_are_resized = true;
  const auto calibration = load_calibration(file, request);
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) {
    (*m)(0, 0) *= 1.25;
    (*m)(0, 2) = ((*m)(0, 2) + 0.5) * 1.25 - 0.5;
    (*m)(1, 1) *= 1.125;
    (*m)(1, 2) = ((*m)(1, 2) + 0.5) * 1.125 - 0.5;
  }
  ASSERT_EQ(calibration.camera.width_px, request.width_px);
  expect_rectifies(calibration, rig);
}

}  // namespace
}  // namespace flies
